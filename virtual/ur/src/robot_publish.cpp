// Published state of the virtual robot, once per cycle.

#include <Eigen/Geometry>
#include <algorithm>

#include "robot.hpp"

namespace metier::virtual_ur {

namespace {

// Values of a robot that is switched on and does nothing.
constexpr double kMainVoltage = 48.0;
constexpr double kMotorTemperature = 28.0;
constexpr double kIdleCurrent = 0.5;

constexpr std::uint32_t kPowerOn = 1U << 0U;
constexpr std::uint32_t kProgramRunning = 1U << 1U;

/// Pose and velocity of the tool's origin.
struct ToolMotion {
    Vector6 pose{};
    Vector6 speed{};
};

ToolMotion toolMotion(const ToolKinematics& tool, const JointState& joints) {
    motion::Jacobian jacobian;
    const auto base_from_flange = tool.arm.forward(toJointVector(joints.position), jacobian);
    const Eigen::Matrix<double, 6, 1> flange =
        jacobian * Eigen::Map<const Eigen::Matrix<double, 6, 1>>(joints.velocity.data());
    const Eigen::Vector3d arm = base_from_flange.rotation * tool.flange_from_tool.translation;
    const Eigen::Vector3d turn = flange.tail<3>();
    const Eigen::Vector3d linear = flange.head<3>() + turn.cross(arm);
    const motion::Pose base_from_tool =
        motion::Pose{base_from_flange.translation, Eigen::Quaterniond(base_from_flange.rotation)} *
        tool.flange_from_tool;
    return {toVector(base_from_tool),
            {linear.x(), linear.y(), linear.z(), turn.x(), turn.y(), turn.z()}};
}

/// Converts a wrench on the flange, in its frame, to the maker's form: on the tool's origin, base
/// frame.
Vector6 forceOnTool(const motion::Wrench& wrench, const motion::Pose& base_from_flange,
                    const motion::Pose& flange_from_tool) {
    const Eigen::Vector3d force = base_from_flange.rotation * wrench.force;
    const Eigen::Vector3d arm = base_from_flange.rotation * flange_from_tool.translation;
    const Eigen::Vector3d torque = base_from_flange.rotation * wrench.torque - arm.cross(force);
    return {force.x(), force.y(), force.z(), torque.x(), torque.y(), torque.z()};
}

}  // namespace

void Robot::publish() {
    state_.target_q = arm_.target().position;
    state_.target_qd = arm_.target().velocity;
    state_.target_qdd = arm_.targetAcceleration();
    const auto actual = arm_.actual();
    state_.actual_q = actual.position;
    state_.actual_qd = actual.velocity;
    publishTool();
    publishModes();
}

void Robot::publishTool() {
    const auto tool = arm_.tool();
    const auto target = toolMotion(tool, arm_.target());
    const auto actual = toolMotion(tool, arm_.actual());
    state_.target_tcp_pose = target.pose;
    state_.target_tcp_speed = target.speed;
    state_.actual_tcp_pose = actual.pose;
    state_.actual_tcp_speed = actual.speed;
    const auto frames = tool.arm.forwardAll(toJointVector(state_.actual_q));
    const auto& elbow = frames[2].translation;
    for (std::size_t i = 0; i < 3; ++i) {
        const double before = state_.elbow_position[i];
        state_.elbow_position[i] = elbow[static_cast<Eigen::Index>(i)];
        state_.elbow_velocity[i] = (state_.elbow_position[i] - before) * rate_;
    }
    const auto& wrench = around_.world.effect().wrench;
    state_.raw_wrench = {wrench.force.x(),  wrench.force.y(),  wrench.force.z(),
                         wrench.torque.x(), wrench.torque.y(), wrench.torque.z()};
    state_.actual_tcp_force = forceOnTool(wrench, frames[kAxes], tool.flange_from_tool);
    for (std::size_t i = 0; i < kAxes; ++i) {
        state_.actual_tcp_force[i] -= state_.force_bias[i];
    }
}

void Robot::publishModes() {
    state_.robot_mode = modes_->robotMode();
    state_.safety_mode = modes_->safetyMode();
    state_.safety_status_bits = modes_->safetyStatusBits();
    state_.joint_mode.fill(static_cast<std::int32_t>(modes_->jointMode()));
    state_.runtime_state = programs_->state();
    state_.script_line = programs_->line();
    const bool powered = state_.robot_mode > RobotMode::power_off;
    const bool running = state_.runtime_state == RuntimeState::playing ||
                         state_.runtime_state == RuntimeState::resuming;
    state_.robot_status_bits = (powered ? kPowerOn : 0U) | (running ? kProgramRunning : 0U);
    state_.main_voltage = kMainVoltage;
    state_.robot_voltage = powered ? kMainVoltage : 0.0;
    state_.robot_current = powered ? kIdleCurrent : 0.0;
    state_.joint_voltage.fill(state_.robot_voltage);
    state_.joint_temperature.fill(kMotorTemperature);
}

}  // namespace metier::virtual_ur
