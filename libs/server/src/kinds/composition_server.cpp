#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <utility>

#include "finding/arm_figures.hpp"
#include "finding/skill_matching.hpp"
#include "host/skill_host.hpp"
#include "kinds/compositions.hpp"
#include "kinds/forces.hpp"
#include "kinds/kinds.hpp"
#include "kinds/look_times.hpp"
#include "kinds/rebinder.hpp"
#include "metier/client/remote_server.hpp"
#include "metier/composition/definition.hpp"
#include "metier/opcua_skill/skill_controller.hpp"
#include "metier/opcua_skill/used_skills.hpp"

namespace metier::server {
namespace {

using composition::Definition;

constexpr std::chrono::milliseconds kSearchPause{200};

/// "ptp, line"
std::string namesOf(const std::vector<composition::Use>& uses) {
    std::string names;
    for (const auto& use : uses) {
        names += (names.empty() ? "" : ", ") + use.alias;
    }
    return names;
}

class CompositionServer final : public Server {
public:
    CompositionServer(const cell::ServerConfig& config, cell::CompositionServer composition,
                      const Identity& identity, std::unique_ptr<SkillHost> host);
    ~CompositionServer() override;

    std::string url() const override { return host_->url(); }
    Result<void> begin(const std::vector<Definition>& definitions, const link::StopSignal& stop);

private:
    class Roles;
    Result<void> connect(const std::vector<cell::UsedServer>& servers);
    Result<void> offer(const std::vector<Definition>& definitions, const link::StopSignal& stop);
    Result<void> offerOne(const opcua_skill::SkillController& place, const Definition& definition,
                          const link::StopSignal& stop);

    Result<std::unique_ptr<client::RemoteServer>> connectTo(const std::string& url,
                                                            const std::string& name);
    Result<std::shared_ptr<client::RemoteServer>> connectFound(const DiscoveredServer& found);
    void keepBound();

    const cell::CompositionServer config_;
    const cell::Discovery discovery_;
    const std::string name_;
    const Identity& identity_;
    std::string life_;  // part of the ids of executions
    std::vector<std::unique_ptr<client::RemoteServer>> servers_;
    std::vector<OfferedSkill> offered_;  // of all compositions
    // Those that were found, shared by the skills that use them.
    std::vector<std::shared_ptr<client::RemoteServer>> found_;
    std::vector<SkillBinding> bindings_;
    std::unique_ptr<Rebinder> rebinder_;
    std::unique_ptr<SkillHost> host_;  // ends before the servers that its skills use
    Forces forces_;
};

/// Finds the used skills of one definition and what to publish of them.
class CompositionServer::Roles {
public:
    Roles(CompositionServer& server, const Definition& definition)
        : server_(server),
          definition_(definition),
          origin_(fmt::format("{}.{}", server.name_, definition.name)) {}

    const std::string& origin() const noexcept { return origin_; }

    /// Errors: a line "file:line: uses.ALIAS: why" for each use that nothing serves; cancelled (a
    ///         stop was asked for).
    Result<void> find(const link::StopSignal& stop) {
        std::string problems;
        for (const auto& use : definition_.uses) {
            const auto found = server_.forces_.check(use).and_then([&] { return findOne(use); });
            if (!found) {
                problems +=
                    fmt::format("{}{}:{}: uses.{}: {}", problems.empty() ? "" : "\n",
                                definition_.file, use.line, use.alias, found.error().message);
            }
        }
        return problems.empty() ? discover(stop) : fail(Errc::invalid_argument, problems);
    }

    /// Hands over what discovery has found, to be kept bound.
    void keepBindings(composition::SequenceSkill& skill, const opcua::NodeId& node) {
        for (auto& binding : bindings_) {
            binding.skill = &skill;
            binding.node = node;
            server_.bindings_.push_back(std::move(binding));
        }
    }

    UsedSkills takeUsedSkills() { return std::move(used_skills_); }

    Result<void> publish(const opcua::NodeId& skills, const std::string& name) {
        auto& nodes = server_.host_->nodes();
        METIER_ASSIGN(const auto user, opcua_skill::findSkillObject(nodes, skills, name));
        for (const auto& used : remote_) {
            METIER_TRY(opcua_skill::publishUse(nodes, user, used));
        }
        for (const auto& used : local_) {
            METIER_ASSIGN(const auto object, opcua_skill::findSkillObject(nodes, skills, used));
            METIER_TRY(opcua_skill::publishUse(nodes, user, object));
        }
        return {};
    }

private:
    Result<void> findOne(const composition::Use& use) {
        const bool own = use.server.empty() || use.server == server_.name_;
        for (auto* program : server_.host_->skills().programs()) {
            if (own && program->description().type == use.type) {
                return checkOwn(use).map([&] { useLocal(use, *program); });
            }
        }
        return findRemote(use);
    }

    void useLocal(const composition::Use& use, skill::Program& program) {
        used_skills_.emplace(use.alias, usedOf(*server_.host_, program, definition_.name));
        const auto& used = program.description().name;
        if (std::find(local_.begin(), local_.end(), used) == local_.end()) {
            local_.push_back(used);
        }
    }

    Result<void> findRemote(const composition::Use& use) {
        auto offered = choose(use, server_.offered_);
        if (!offered && offered.error().code == Errc::not_found && server_.config_.discover) {
            sought_.push_back(use);
            return {};
        }
        if (!offered && offered.error().code == Errc::not_found && use.optional) {
            return {};
        }
        if (!offered) {
            return fail(std::move(offered.error()));
        }
        auto& remote = *server_.servers_[offered->index];
        return take(use, remote, offered->address);
    }

    Result<void> take(const composition::Use& use, client::RemoteServer& remote,
                      const client::SkillAddress& skill) {
        METIER_ASSIGN(auto used, remote.use(skill, origin_));
        auto recorded = server_.host_->recorded(
            std::move(used), {remote.name(), skill.controllerName(), skill.name});
        METIER_ASSIGN(auto limited, server_.forces_.limit(use, std::move(recorded)));
        used_skills_.emplace(use.alias, std::move(limited));
        remote_.push_back(
            {use.alias, remote.url(), skill.name, skill.type_name, skill.controllerName()});
        return {};
    }

    /// Others may be starting at this moment.
    Result<void> discover(const link::StopSignal& stop) {
        if (!sought_.empty()) {
            spdlog::info("{} seeks {}", definition_.name, namesOf(sought_));
        }
        const auto deadline = std::chrono::steady_clock::now() + kLongestSearch;
        while (!sought_.empty()) {
            const auto servers = discoverServers(server_.discovery_, server_.identity_, {});
            const auto assigned = assign(sought_, servers);
            if (assigned) {
                return useAll(*assigned);
            }
            if (std::chrono::steady_clock::now() > deadline) {
                return fail(Errc::not_found,
                            fmt::format("{}: {}", definition_.file, assigned.error().message));
            }
            if (stop.waitUntil(std::chrono::steady_clock::now() + kSearchPause)) {
                return fail(Errc::cancelled, fmt::format("stopped before {} had found {}",
                                                         definition_.name, namesOf(sought_)));
            }
        }
        return {};
    }

    Result<void> useAll(const std::vector<Assignment>& assignments) {
        for (const auto& [server, uses] : assignments) {
            const auto chosen = chooseAll(uses, *server);
            METIER_ASSIGN(auto remote,
                          chosen ? server_.connectFound(*server) : fail(chosen.error()));
            for (const auto& use : uses) {
                METIER_TRY(take(use, *remote, chosen->at(use.alias).address));
            }
            spdlog::info("{} uses {} ({})", definition_.name, remote->name(), remote->url());
            bindings_.push_back({definition_.name, nullptr, {}, origin_, uses, remote});
        }
        return {};
    }

    CompositionServer& server_;
    const Definition& definition_;
    std::string origin_;
    UsedSkills used_skills_;
    std::vector<opcua_skill::RemoteSkill> remote_;
    std::vector<std::string> local_;        // names of used skills of this server
    std::vector<composition::Use> sought_;  // uses that no server of the list has
    std::vector<SkillBinding> bindings_;
};

Result<void> CompositionServer::begin(const std::vector<Definition>& definitions,
                                      const link::StopSignal& stop) {
    METIER_TRY(connect(config_.servers));
    METIER_TRY(forces_.connect(config_, identity_));
    METIER_TRY(offer(definitions, stop));
    METIER_TRY(host_->start());
    keepBound();
    return {};
}

CompositionServer::CompositionServer(const cell::ServerConfig& config,
                                     cell::CompositionServer composition, const Identity& identity,
                                     std::unique_ptr<SkillHost> host)
    : config_(std::move(composition)),
      discovery_(config.discovery),
      name_(config.name),
      identity_(identity),
      life_(newLife()),
      host_(std::move(host)),
      forces_(name_, *host_) {}

CompositionServer::~CompositionServer() {
    if (rebinder_) {
        rebinder_->stop();
    }
}

void CompositionServer::keepBound() {
    if (bindings_.empty()) {
        return;
    }
    rebinder_ = std::make_unique<Rebinder>(
        Rebinder::Setup{.discovery = discovery_,
                        .identity = identity_,
                        .own_url = host_->announcedUrl(),
                        .application_name = "metier " + name_,
                        .own_server = host_->applicationUri(),
                        .rebind_after = std::chrono::duration<double>(config_.rebind_after),
                        .executor = host_->skills().executor(),
                        .host = *host_,
                        .forces = forces_},
        std::move(bindings_));
}

Result<std::unique_ptr<client::RemoteServer>> CompositionServer::connectTo(
    const std::string& url, const std::string& name) {
    return client::RemoteServer::connect({.url = url,
                                          .name = name,
                                          .application_name = "metier " + name_,
                                          .security = identity_.credentials(),
                                          .own_server = host_->applicationUri()},
                                         host_->skills().executor());
}

Result<std::shared_ptr<client::RemoteServer>> CompositionServer::connectFound(
    const DiscoveredServer& found) {
    for (const auto& known : found_) {
        if (known->url() == found.found.url) {
            return known;
        }
    }
    METIER_ASSIGN(auto server, connectTo(found.found.url, found.found.name));
    found_.emplace_back(std::move(server));
    return found_.back();
}

Result<void> CompositionServer::connect(const std::vector<cell::UsedServer>& servers) {
    for (const auto& used : servers) {
        METIER_ASSIGN(auto server, connectTo(used.url, used.name));
        METIER_ASSIGN(auto skills, server->skills());
        for (auto& skill : skills) {
            const auto arm = figuresOfArm(server->client(), skill);
            offered_.push_back({used.name, servers_.size(), std::move(skill), arm});
        }
        servers_.push_back(std::move(server));
    }
    return {};
}

Result<void> CompositionServer::offer(const std::vector<Definition>& definitions,
                                      const link::StopSignal& stop) {
    METIER_ASSIGN(const auto place,
                  opcua_skill::publishSkillController(host_->nodes(), name_,
                                                      "Skills that are made of other skills."));
    for (const auto& definition : definitions) {
        METIER_TRY(offerOne(place, definition, stop));
    }
    return host_->offerControl(place.controller);
}

Result<void> CompositionServer::offerOne(const opcua_skill::SkillController& place,
                                         const Definition& definition,
                                         const link::StopSignal& stop) {
    Roles roles(*this, definition);
    METIER_TRY(roles.find(stop));
    METIER_ASSIGN(auto* const skill, publishSequence(*host_, place.skills,
                                                     {definition, roles.takeUsedSkills(),
                                                      roles.origin() + "~" + life_}));
    METIER_ASSIGN(const auto node,
                  opcua_skill::findSkillObject(host_->nodes(), place.skills, definition.name));
    roles.keepBindings(*skill, node);
    return roles.publish(place.skills, definition.name);
}

}  // namespace

Result<std::unique_ptr<Server>> serve(const cell::ServerConfig& config,
                                      const cell::CompositionServer& composition,
                                      const Context& context) {
    METIER_ASSIGN(const auto definitions, loadDefinitions(composition.files));
    METIER_ASSIGN(auto host, SkillHost::create(config, context.identity, {}));
    auto server =
        std::make_unique<CompositionServer>(config, composition, context.identity, std::move(host));
    METIER_TRY(server->begin(definitions, context.stop));
    return server;
}

}  // namespace metier::server
