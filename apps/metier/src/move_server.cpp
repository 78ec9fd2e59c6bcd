#include "move_server.hpp"

#include <fmt/format.h>

#include <utility>

#include "kinematics_conversion.hpp"

namespace metier::app {
namespace {

// What a motion leaves of velocity and acceleration, so that the arm can follow its stream exactly.
constexpr double kShare = 0.98;

Result<motion::RobotModel> modelOf(const remote_arm::RemoteArm& arm) {
    const auto position = arm.state().position;
    const std::vector<double> current(position.begin(), position.end());
    auto chain = toChain(arm.kinematics(), current);
    if (!chain) {
        return fail(chain.error());
    }
    for (auto& joint : chain->joints) {
        joint.limits.velocity *= kShare;
        joint.limits.acceleration *= kShare;
    }
    return motion::RobotModel::fromChain(std::move(*chain));
}

opcua_skill::MotionDeviceSystemSpec specOf(const std::string& name, const device::ArmInfo& arm) {
    opcua_skill::MotionDeviceSystemSpec spec;
    spec.name = arm.name;
    spec.description = fmt::format("Move skills of {} over its position stream", arm.name);
    spec.manufacturer = "metier";
    spec.model = name;
    spec.axis_names = arm.axis_names;
    return spec;
}

}  // namespace

Result<std::unique_ptr<MoveServer>> MoveServer::start(const configuration::ServerConfig& config) {
    auto arm = remote_arm::RemoteArm::connect({.url = config.move.robot});
    if (!arm) {
        return fail(arm.error().code,
                    fmt::format("{}: {}", config.move.robot, arm.error().message));
    }
    auto model = modelOf(**arm);
    if (!model) {
        return fail(model.error());
    }
    auto host = SkillHost::create(config, {});
    if (!host) {
        return fail(host.error());
    }
    std::unique_ptr<MoveServer> server(
        new MoveServer(std::move(*model), std::move(*arm), std::move(*host)));
    if (auto offered = server->offer(config.name); !offered) {
        return fail(offered.error());
    }
    if (auto started = server->host_->start(); !started) {
        return fail(started.error());
    }
    return server;
}

MoveServer::MoveServer(motion::RobotModel model, std::unique_ptr<remote_arm::RemoteArm> arm,
                       std::unique_ptr<SkillHost> host)
    : model_(std::move(model)), arm_(std::move(arm)), host_(std::move(host)) {}

Result<void> MoveServer::offer(const std::string& name) {
    const auto system =
        opcua_skill::publishMotionDeviceSystem(host_->nodes(), specOf(name, arm_->info()));
    if (!system) {
        return fail(system.error());
    }
    auto arm_skills = robot_skills::makeArmSkills(*arm_, model_, host_->clock());
    if (!arm_skills) {
        return fail(arm_skills.error());
    }
    for (auto& move : arm_skills->moves) {
        const auto published = host_->skills().publish(
            system->skills, std::move(move),
            {.resource = arm_skills->resource, .control = host_->control()});
        if (!published) {
            return fail(published.error());
        }
    }
    if (auto offered = host_->offerControl(system->controller); !offered) {
        return offered;
    }
    host_->haltOnLossOf(*arm_);
    return host_->publishArm(*system, {*arm_, model_, arm_->kinematics().payload});
}

}  // namespace metier::app
