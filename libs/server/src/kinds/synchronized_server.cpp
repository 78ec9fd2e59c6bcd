#include "kinds/synchronized_server.hpp"

#include <fmt/format.h>

#include <utility>

#include "finding/skill_matching.hpp"
#include "kinds/composition_files.hpp"
#include "metier/opcua_skill/skill_controller.hpp"

namespace metier::server {

using composition::Arm;

namespace {

// Arms whose component is gone run on no longer than that, and what it takes to see it.
constexpr std::chrono::milliseconds kSessionTimeout{2'000};
constexpr const char* kSkill = "SynchronizedMoveSkill";

std::string originOf(const std::string& component) {
    return fmt::format("{}.{}", component, kSkill);
}

}  // namespace

Result<std::unique_ptr<SynchronizedServer>> SynchronizedServer::start(
    const cell::ServerConfig& config, const cell::SynchronizedServer& arms,
    const Context& context) {
    auto host = SkillHost::create(config, context.identity, {});
    if (!host) {
        return fail(host.error());
    }
    std::unique_ptr<SynchronizedServer> server(
        new SynchronizedServer(context.identity, std::move(*host)));
    if (auto offered = server->offer(config.name, arms); !offered) {
        return fail(std::move(offered.error()));
    }
    if (auto started = server->host_->start(); !started) {
        return fail(started.error());
    }
    return server;
}

Result<std::unique_ptr<composition::UsedSkill>> SynchronizedServer::use(
    client::RemoteServer& server, const std::string& type, const std::string& component) {
    auto skills = server.skills();
    if (!skills) {
        return fail(std::move(skills.error()));
    }
    std::vector<OfferedSkill> offered;
    for (auto& skill : *skills) {
        offered.push_back({server.name(), 0, std::move(skill)});
    }
    composition::Use wanted;
    wanted.type = type;
    wanted.server = server.name();
    const auto chosen = choose(wanted, offered);
    if (!chosen) {
        return fail(chosen.error());
    }
    const auto& address = chosen->address;
    used_.push_back({fmt::format("{}.{}", server.name(), address.name), server.url(), address.name,
                     address.type_name, address.controllerName()});
    return server.use(address, originOf(component));
}

Result<Arm> SynchronizedServer::connect(const cell::UsedServer& used,
                                        const std::string& component) {
    auto server = client::RemoteServer::connect({.url = used.url,
                                                       .name = used.name,
                                                       .application_name = "metier " + component,
                                                       .session_timeout = kSessionTimeout,
                                                       .security = identity_.credentials(),
                                                       .own_server = host_->applicationUri()},
                                                      host_->skills().executor());
    if (!server) {
        return fail(std::move(server.error()));
    }
    servers_.push_back(std::move(*server));
    auto pose_move = use(*servers_.back(), "CartesianPtpMoveSkillType", component);
    if (!pose_move) {
        return fail(std::move(pose_move.error()));
    }
    auto joint_move = use(*servers_.back(), "JointPtpMoveSkillType", component);
    if (!joint_move) {
        return fail(std::move(joint_move.error()));
    }
    if (const auto why = composition::unfitReason((*joint_move)->description());
        !why.empty()) {
        return fail(Errc::not_supported, fmt::format("{}: {}", used.name, why));
    }
    return Arm{used.name, std::move(*pose_move), std::move(*joint_move)};
}

Result<void> SynchronizedServer::offer(const std::string& name,
                                       const cell::SynchronizedServer& config) {
    const auto place =
        opcua_skill::publishSkillController(host_->nodes(), name, "Moves several arms together.");
    if (!place) {
        return fail(place.error());
    }
    std::vector<Arm> arms;
    for (const auto& used : config.servers) {
        auto arm = connect(used, name);
        if (!arm) {
            return fail(std::move(arm.error()));
        }
        arms.push_back(std::move(*arm));
    }
    composition::Options options{host_->skills().executor(), host_->clock(),
                                       originOf(name) + "~" + newLife(),
                                       std::chrono::duration<double>(config.start_delay)};
    const auto published =
        host_->skills().publish(place->skills,
                                std::make_unique<composition::SynchronizedMoveSkill>(
                                    std::move(arms), std::move(options)),
                                {.control = host_->control(),
                                 .names = host_->names(),
                                 .rest_deadline = composition::kRestDeadline});
    if (!published) {
        return fail(published.error());
    }
    const auto object = opcua_skill::findSkillObject(host_->nodes(), place->skills, kSkill);
    if (!object) {
        return fail(object.error());
    }
    for (const auto& used : used_) {
        if (auto shown = opcua_skill::publishUse(host_->nodes(), *object, used); !shown) {
            return shown;
        }
    }
    return host_->offerControl(place->controller);
}

}  // namespace metier::server
