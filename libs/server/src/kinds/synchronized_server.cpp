#include <fmt/format.h>

#include <utility>

#include "finding/skill_matching.hpp"
#include "host/skill_host.hpp"
#include "kinds/compositions.hpp"
#include "kinds/kinds.hpp"
#include "metier/client/remote_server.hpp"
#include "metier/composition/synchronized_move_skill.hpp"
#include "metier/opcua_skill/skill_controller.hpp"
#include "metier/opcua_skill/used_skills.hpp"

namespace metier::server {
namespace {

using composition::Arm;

// Arms whose component has died run on no longer than this, and the time to detect it.
constexpr std::chrono::milliseconds kSessionTimeout{2'000};
constexpr const char* kSkill = "SynchronizedMoveSkill";

std::string originOf(const std::string& component) {
    return fmt::format("{}.{}", component, kSkill);
}

class SynchronizedServer final : public Server {
public:
    SynchronizedServer(const Identity& identity, std::unique_ptr<SkillHost> host)
        : identity_(identity), host_(std::move(host)) {}

    std::string url() const override { return host_->url(); }
    Result<void> begin(const std::string& name, const cell::SynchronizedServer& config);

private:
    Result<Arm> connect(const cell::UsedServer& used, const std::string& component);
    Result<std::unique_ptr<composition::UsedSkill>> use(client::RemoteServer& server,
                                                        const std::string& type,
                                                        const std::string& component);

    const Identity& identity_;
    std::vector<std::unique_ptr<client::RemoteServer>> servers_;
    std::vector<opcua_skill::RemoteSkill> used_;
    std::unique_ptr<SkillHost> host_;  // ends before the servers that its skill uses
};

Result<std::unique_ptr<composition::UsedSkill>> SynchronizedServer::use(
    client::RemoteServer& server, const std::string& type, const std::string& component) {
    METIER_ASSIGN(auto skills, server.skills());
    std::vector<OfferedSkill> offered;
    for (auto& skill : skills) {
        offered.push_back({server.name(), 0, std::move(skill)});
    }
    composition::Use wanted;
    wanted.type = type;
    wanted.server = server.name();
    METIER_ASSIGN(const auto chosen, choose(wanted, offered));
    const auto& address = chosen.address;
    used_.push_back({fmt::format("{}.{}", server.name(), address.name), server.url(), address.name,
                     address.type_name, address.controllerName()});
    return server.use(address, originOf(component));
}

Result<Arm> SynchronizedServer::connect(const cell::UsedServer& used,
                                        const std::string& component) {
    METIER_ASSIGN(auto server,
                  client::RemoteServer::connect({.url = used.url,
                                                 .name = used.name,
                                                 .application_name = "metier " + component,
                                                 .session_timeout = kSessionTimeout,
                                                 .security = identity_.credentials(),
                                                 .own_server = host_->applicationUri()},
                                                host_->skills().executor()));
    servers_.push_back(std::move(server));
    METIER_ASSIGN(auto pose_move, use(*servers_.back(), "CartesianPtpMoveSkillType", component));
    METIER_ASSIGN(auto joint_move, use(*servers_.back(), "JointPtpMoveSkillType", component));
    if (const auto why = composition::unfitReason(joint_move->description()); !why.empty()) {
        return fail(Errc::not_supported, fmt::format("{}: {}", used.name, why));
    }
    return Arm{used.name, std::move(pose_move), std::move(joint_move)};
}

Result<void> SynchronizedServer::begin(const std::string& name,
                                       const cell::SynchronizedServer& config) {
    METIER_ASSIGN(const auto place, opcua_skill::publishSkillController(
                                        host_->nodes(), name, "Moves several arms together."));
    std::vector<Arm> arms;
    for (const auto& used : config.servers) {
        METIER_ASSIGN(auto arm, connect(used, name));
        arms.push_back(std::move(arm));
    }
    composition::Options options{host_->skills().executor(), host_->clock(),
                                 originOf(name) + "~" + newLife(),
                                 std::chrono::duration<double>(config.start_delay)};
    METIER_TRY(host_->skills().publish(
        place.skills,
        std::make_unique<composition::SynchronizedMoveSkill>(std::move(arms), std::move(options)),
        {.control = host_->control(),
         .names = host_->names(),
         .rest_deadline = composition::kRestDeadline}));
    METIER_ASSIGN(const auto object,
                  opcua_skill::findSkillObject(host_->nodes(), place.skills, kSkill));
    for (const auto& used : used_) {
        METIER_TRY(opcua_skill::publishUse(host_->nodes(), object, used));
    }
    METIER_TRY(host_->offerControl(place.controller));
    return host_->start();
}

}  // namespace

Result<std::unique_ptr<Server>> serve(const cell::ServerConfig& config,
                                      const cell::SynchronizedServer& arms,
                                      const Context& context) {
    METIER_ASSIGN(auto host, SkillHost::create(config, context.identity, {}));
    auto server = std::make_unique<SynchronizedServer>(context.identity, std::move(host));
    METIER_TRY(server->begin(config.name, arms));
    return server;
}

}  // namespace metier::server
