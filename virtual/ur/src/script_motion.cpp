// Requests of programs to the arm: motions and kinematics.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "script_robot.hpp"

namespace metier::virtual_ur {

namespace {

// Deceleration when a program ends or gives up a motion [rad/s2].
constexpr double kProgramStop = 10.0;

using urscript::Target;

// Deceleration of the arm before a move begins [rad/s2].
constexpr double kStopBeforeMove = 10.0;

bool isFinite(const Vector6& values) {
    return std::all_of(values.begin(), values.end(), [](double x) { return std::isfinite(x); });
}

Result<Vector6> solve(const Arm& arm, const motion::Pose& base_from_flange, const Vector6& near) {
    motion::IkRequest request;
    request.reference = toJointVector(near);
    return arm.model().kinematics().inverse(base_from_flange, request).map([](const auto& found) {
        return toVector6(found);
    });
}

/// Pose of the tool's origin, in the base frame.
motion::Pose poseOf(const ToolKinematics& tool, const Target& target) {
    if (const auto* q = std::get_if<Vector6>(&target)) {
        return tool.arm.forward(toJointVector(*q)) * tool.flange_from_tool;
    }
    return toPose(std::get<urscript::Pose>(target).value);
}

/// Destination of a move; empty for other motions.
struct Destination {
    std::optional<Target> operator()(const urscript::Move& move) const { return move.target; }
    template <typename Other>
    std::enable_if_t<!std::is_base_of_v<urscript::Move, Other>, std::optional<Target>> operator()(
        const Other&) const {
        return std::nullopt;
    }
};

/// Begins each kind of motion.
class Starter {
public:
    explicit Starter(Arm& arm, double cycle) : arm_(arm), cycle_(cycle) {}

    Result<void> operator()(const urscript::ServoJ& servo) {
        if (!isFinite(servo.joint_position)) {
            return fail(Errc::invalid_argument, "servoj: joint position is not finite");
        }
        const double lookahead = std::clamp(servo.lookahead_time, 0.03, 0.2);
        const double gain = std::clamp(servo.gain, 100.0, 2000.0);
        arm_.servo(servo.joint_position, std::max(servo.time, cycle_), lookahead + 1.0 / gain);
        return {};
    }
    Result<void> operator()(const urscript::SpeedJ& speed) {
        if (!isFinite(speed.velocity)) {
            return fail(Errc::invalid_argument, "speedj: joint velocity is not finite");
        }
        arm_.begin(speedJ(speed.velocity, positive(speed.acceleration, 1.4), speed.time));
        return {};
    }
    Result<void> operator()(const urscript::SpeedL& speed) {
        if (!isFinite(speed.twist)) {
            return fail(Errc::invalid_argument, "speedl: tool velocity is not finite");
        }
        arm_.begin(speedL(speed.twist, positive(speed.acceleration, 1.2), speed.time, arm_.tool()));
        return {};
    }
    Result<void> operator()(const urscript::MoveJ& move) { return joint(move, pathOf(move)); }
    Result<void> operator()(const urscript::MoveL& move) { return line(move, pathOf(move)); }
    Result<void> operator()(const urscript::MoveP& move) { return line(move, pathOf(move)); }
    Result<void> operator()(const urscript::MoveC& move) { return line(move, pathOf(move)); }
    Result<void> operator()(const urscript::ServoC& servo) {
        return pose(servo.target).map([&](const motion::Pose& target) {
            arm_.servoLine(
                target, {positive(servo.velocity, 0.25), positive(servo.acceleration, 1.2), 0.0});
        });
    }
    Result<void> operator()(const urscript::OptimoveJ& move) {
        // Shares of what the arm can do; its slowest axis stands for all.
        const auto& limits = arm_.model().limits(0);
        return joint(
            move, {move.velocity * limits.velocity, move.acceleration * limits.acceleration, 0.0});
    }
    Result<void> operator()(const urscript::OptimoveL& move) {
        const auto& limits = arm_.model().cartesianLimits();
        return line(
            move, {move.velocity * limits.velocity, move.acceleration * limits.acceleration, 0.0});
    }
    Result<void> operator()(const urscript::StopJ& stop) {
        arm_.begin(stopJ(positive(stop.acceleration, 2.0)));
        return {};
    }
    Result<void> operator()(const urscript::StopL& stop) {
        // All axes stand when the tool would.
        const auto& velocity = arm_.target().velocity;
        const auto jacobian =
            arm_.model().kinematics().jacobian(toJointVector(arm_.target().position));
        const double tool_speed =
            (jacobian * Eigen::Map<const Eigen::Matrix<double, 6, 1>>(velocity.data()))
                .head<3>()
                .norm();
        const double seconds = tool_speed / positive(stop.acceleration, 10.0);
        arm_.begin(stopJ(largest(velocity) / std::max(seconds, cycle_)));
        return {};
    }
    Result<void> operator()(const urscript::DirectTorque&) {
        arm_.begin(stopJ(kStopBeforeMove));
        return {};
    }

private:
    static double positive(double value, double otherwise) {
        return std::isfinite(value) && value > 0.0 ? value : otherwise;
    }
    static PathSpeed pathOf(const urscript::Move& move) {
        return {move.velocity, move.acceleration, move.time};
    }
    Result<void> joint(const urscript::Move& move, const PathSpeed& speed) {
        METIER_ASSIGN(auto target, jointTarget(move.target));
        arm_.beginStanding(
            [to = target, speed](const Vector6& start) { return moveJ(start, to, speed); },
            kStopBeforeMove);
        return {};
    }
    Result<void> line(const urscript::Move& move, const PathSpeed& speed) {
        return pose(move.target).map([&](const motion::Pose& target) {
            arm_.beginStanding(
                [target, speed, tool = arm_.tool()](const Vector6& start) {
                    return moveL(start, target, speed, tool);
                },
                kStopBeforeMove);
        });
    }
    /// Pose of the tool; a target that no joint position reaches is refused before the arm moves.
    Result<motion::Pose> pose(const Target& target) const {
        return jointTarget(target).map([&](const Vector6&) { return poseOf(arm_.tool(), target); });
    }
    Result<Vector6> jointTarget(const Target& target) const {
        const auto* q = std::get_if<Vector6>(&target);
        const auto& values = q != nullptr ? *q : std::get<urscript::Pose>(target).value;
        if (!isFinite(values)) {
            return fail(Errc::invalid_argument, "the target of a move is not finite");
        }
        return q != nullptr ? Result<Vector6>(*q)
                            : solve(arm_, toPose(values) * arm_.tool().flange_from_tool.inverse(),
                                    arm_.target().position);
    }

    Arm& arm_;
    double cycle_;
};

}  // namespace

Result<Vector6> ScriptRobot::jointPositionHistory(int cycles) const {
    const auto found =
        cycles < 0 ? std::nullopt : parts_.arm.history(static_cast<std::size_t>(cycles));
    if (!found) {
        return fail(Errc::out_of_range,
                    fmt::format("no joint positions of {} cycles ago are kept", cycles));
    }
    return *found;
}

Result<void> ScriptRobot::beginMotion(const urscript::Motion& motion) {
    abandoned_ = false;
    motion_ = motion;
    return std::visit(Starter(parts_.arm, parts_.cycle), motion);
}

void ScriptRobot::abandonMotion() {
    abandoned_ = true;
    motion_.reset();
}

void ScriptRobot::endCycle() {
    if (abandoned_) {
        abandoned_ = false;
        parts_.arm.begin(stopJ(kProgramStop));
    }
}

void ScriptRobot::resumeMotion() {
    // A servo is fed by its program, and a stop was done.
    const bool once = motion_ && !std::holds_alternative<urscript::ServoJ>(*motion_) &&
                      !std::holds_alternative<urscript::ServoC>(*motion_) &&
                      !std::holds_alternative<urscript::StopJ>(*motion_) &&
                      !std::holds_alternative<urscript::StopL>(*motion_);
    if (once) {
        (void)beginMotion(urscript::Motion(*motion_));  // it could begin before
    }
}

Result<Vector6> ScriptRobot::inverseKinematics(const urscript::Pose& base_from_tool,
                                               const Vector6& near,
                                               const urscript::Pose& flange_from_tool) const {
    if (!isFinite(base_from_tool.value) || !isFinite(near) || !isFinite(flange_from_tool.value)) {
        return fail(Errc::invalid_argument, "get_inverse_kin: a number is not finite");
    }
    return solve(parts_.arm,
                 toPose(base_from_tool.value) * toPose(flange_from_tool.value).inverse(), near);
}

bool ScriptRobot::withinLimits(const Target& target) const {
    if (const auto* q = std::get_if<Vector6>(&target)) {
        return isFinite(*q) && parts_.arm.withinLimits(*q);
    }
    return inverseKinematics(std::get<urscript::Pose>(target), parts_.arm.target().position,
                             seen_.flange_from_tool)
        .has_value();
}

urscript::Pose ScriptRobot::targetWaypoint() const {
    const bool going = motion_ && !parts_.arm.motionDone();
    const auto target = going ? std::visit(Destination(), *motion_) : std::nullopt;
    return target ? urscript::Pose{toVector(poseOf(parts_.arm.tool(), *target))}
                  : seen_.target_tool_pose;
}

Result<urscript::Pose> ScriptRobot::forwardKinematics(
    const Vector6& joint_position, const urscript::Pose& flange_from_tool) const {
    if (!isFinite(joint_position) || !isFinite(flange_from_tool.value)) {
        return fail(Errc::invalid_argument, "get_forward_kin: a number is not finite");
    }
    return urscript::Pose{
        toVector(parts_.arm.model().kinematics().forward(toJointVector(joint_position)) *
                 toPose(flange_from_tool.value))};
}

}  // namespace metier::virtual_ur
