#include "kinds/robot_moves.hpp"

#include <fmt/format.h>

#include <utility>

#include "metier/server/kinematics_conversion.hpp"

namespace metier::server {
namespace {

// Share of velocity and acceleration that a motion uses, so that the arm can follow its stream
// exactly.
constexpr double kShare = 0.98;

Result<motion::RobotModel> modelOf(const client::RemoteArm& arm) {
    const auto position = arm.state().position;
    const std::vector<double> current(position.begin(), position.end());
    METIER_ASSIGN(auto chain, toChain(arm.kinematics(), current));
    for (auto& joint : chain.joints) {
        joint.limits.velocity *= kShare;
        joint.limits.acceleration *= kShare;
    }
    return motion::RobotModel::fromChain(std::move(chain));
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

Result<ConnectedRobot> connectRobot(const std::string& url, const Identity& identity) {
    auto arm = client::RemoteArm::connect({.url = url, .security = identity.credentials()});
    if (!arm) {
        return fail(arm.error().code, fmt::format("{}: {}", url, arm.error().message));
    }
    auto model = modelOf(**arm);
    if (!model) {
        return fail(model.error().code, fmt::format("{}: {}", url, model.error().message));
    }
    return ConnectedRobot{url, std::move(*arm), std::move(*model)};
}

Result<std::unique_ptr<RobotMoves>> RobotMoves::serve(
    const cell::ServerConfig& config, const Identity& identity, ConnectedRobot robot,
    std::shared_ptr<skill::ExecutionNames> names) {
    METIER_ASSIGN(auto host, SkillHost::create(config, identity, {}, std::move(names)));
    std::unique_ptr<RobotMoves> moves(new RobotMoves(std::move(robot), std::move(host)));
    METIER_TRY(moves->offer(config.name));
    METIER_TRY(moves->host_->start());
    return moves;
}

RobotMoves::RobotMoves(ConnectedRobot robot, std::unique_ptr<SkillHost> host)
    : robot_(std::move(robot)), host_(std::move(host)) {}

Result<void> RobotMoves::offer(const std::string& name) {
    auto& arm = *robot_.arm;
    arm.nameOwner(host_->applicationUri());
    METIER_ASSIGN(const auto system,
                  opcua_skill::publishMotionDeviceSystem(host_->nodes(), specOf(name, arm.info())));
    METIER_ASSIGN(auto skills, robot_skills::makeArmSkills({arm}, robot_.model, host_->clock()));
    for (auto& move : skills.moves) {
        METIER_TRY(host_->skills().publish(
            system.skills, std::move(move),
            {.resource = skills.resource, .control = host_->control(), .names = host_->names()}));
    }
    METIER_TRY(host_->offerControl(system.controller));
    host_->haltOnLossOf(arm);
    return host_->publishArm(system, {.arm = arm,
                                      .model = robot_.model,
                                      .payload = arm.kinematics().payload,
                                      .stopping = skills.stopping_report});
}

}  // namespace metier::server
