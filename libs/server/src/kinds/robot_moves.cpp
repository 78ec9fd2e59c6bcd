#include "kinds/robot_moves.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <utility>

#include "metier/motion/frame.hpp"
#include "metier/server/kinematics_conversion.hpp"

namespace metier::server {
namespace {

// Share of velocity and acceleration that a motion uses, so that the arm can follow its stream
// exactly.
constexpr double kShare = 0.98;

/// The chain with the share of its limits that motions use.
motion::ChainDescription reduced(motion::ChainDescription chain) {
    for (auto& joint : chain.joints) {
        joint.limits.velocity *= kShare;
        joint.limits.acceleration *= kShare;
    }
    return chain;
}

/// \param file_model of the robot, if there is one
Result<motion::RobotModel> modelOf(const client::RemoteArm& arm,
                                   const std::optional<motion::RobotModel>& file_model) {
    if (arm.usesGivenModel() && file_model) {
        return file_model->withChain(reduced(file_model->chain()));
    }
    const auto position = arm.state().position;
    const std::vector<double> current(position.begin(), position.end());
    METIER_ASSIGN(auto chain, toChain(arm.kinematics(), current));
    return motion::RobotModel::fromChain(reduced(std::move(chain)));
}

client::GivenArm givenArm(const motion::RobotModel& model, const cell::MoveComponent& move) {
    client::GivenArm given;
    given.kinematics = toKinematicsData(model);
    for (const auto& joint : model.chain().joints) {
        given.joint_names.push_back(joint.name);
    }
    given.array_order = move.axes;
    given.device = move.device;
    given.pose_at = [kinematics = model.kinematics()](const device::JointArray& joints) {
        motion::JointVector position(joints.size());
        std::copy(joints.begin(), joints.end(), position.begin());
        return motion::toFrame(kinematics.forward(position));
    };
    return given;
}

Result<std::optional<motion::RobotModel>> loadModel(const cell::MoveComponent& move) {
    if (move.model.empty()) {
        return std::optional<motion::RobotModel>();
    }
    METIER_ASSIGN(auto model, motion::RobotModel::load(move.model));
    return std::optional(std::move(model));
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

Result<ConnectedRobot> connectRobot(const std::string& url, const cell::MoveComponent& move,
                                    const Identity& identity) {
    METIER_ASSIGN(const auto file_model, loadModel(move));
    client::RemoteArmOptions options{
        .url = url, .security = identity.credentials(), .controller = move.controller};
    if (file_model) {
        options.given = givenArm(*file_model, move);
    }
    auto arm = client::RemoteArm::connect(std::move(options));
    if (!arm) {
        return fail(arm.error().code, fmt::format("{}: {}", url, arm.error().message));
    }
    auto model = modelOf(**arm, file_model);
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
