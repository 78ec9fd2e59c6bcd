#include "robot_application.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "metier/base/numbers.hpp"

namespace metier::virtual_iiwa {

namespace {

using motion::JointVector;
using motion::Pose;
using Arguments = std::array<double, 7>;

constexpr int kPtp = 21;
constexpr int kLin = 22;
constexpr int kServoInterface = 32;
constexpr int kSynchronous = 52;
constexpr int kPeriodical = 12;

/// The codes that one setting takes.
struct Choice {
    int command;
    int first;
    int last;
};
constexpr std::array kChoices{Choice{301, 11, 12}, Choice{302, 31, 32}, Choice{303, 21, 24},
                              Choice{304, 41, 44}, Choice{305, 51, 52}};

/// False for NaN too.
bool within(double value, double lower, double upper) {
    return value >= lower && value <= upper;
}

bool isWhole(double value) {
    return within(value, -1e6, 1e6) && value == std::trunc(value);
}

/// Rounds like the application's language; 0 for NaN.
int rounded(double value) {
    return within(value, -1e6, 1e6) ? static_cast<int>(std::floor(value + 0.5)) : 0;
}

/// Commands that stop what moves before anything else.
bool stopsFirst(int code) {
    return code == 101 || code == 211 || code == 212 || within(code, 301, 305) || code == 400;
}

}  // namespace

JointVector Cabinet::externalTorque() const {
    const auto jacobian = arm.model().kinematics().jacobian(arm.position());
    const auto flange = arm.model().kinematics().forward(arm.position());
    Eigen::Matrix<double, 6, 1> base_wrench;
    base_wrench << flange.rotation * wrench.force, flange.rotation * wrench.torque;
    JointVector torque = torque_noise;
    torque.view() += jacobian.transpose() * base_wrench;
    return torque;
}

// ---- commands ----------------------------------------------------------------------------------

RobotApplication::Answer RobotApplication::execute(const Command& command) {
    if (command.code < 0.0) {
        return Answer::application_ends;
    }
    status_ = false;
    waiting_ = false;
    asked_to_move_ = false;
    const int code = rounded(command.code);
    if (stopsFirst(code)) {
        cabinet_.arm.brake(Arm::End::cancelled);
        fired_ = false;  // the motion that it was about is forgotten
    }
    if (code == 212 && !within(rounded(command.arguments[0]), 0, 6)) {
        return Answer::application_ends;
    }
    status_ = dispatch(code, command.arguments);
    if (std::exchange(silent_, false)) {
        return Answer::then_no_more;
    }
    waiting_ = status_ && asked_to_move_ && synchronous_;
    return waiting_ ? Answer::after_motion : Answer::at_once;
}

bool RobotApplication::dispatch(int code, const Arguments& arguments) {
    switch (code) {
        case 101:
            return true;
        case 102:
            return moveJoints(arguments);
        case 103:
            return movePose(arguments);
        case 104:
            return moveCircle(arguments);
        case 211:
            return setForceCondition(arguments);
        case 212:
            return setTorqueCondition(arguments);
        case 400:
            return attachTool(arguments[0]);
        default:
            break;
    }
    if (within(code, 201, 206)) {
        return setLimit(code, arguments[0]);
    }
    if (within(code, 221, 243)) {
        setImpedance(code, arguments);
        return true;
    }
    // An unknown command is refused without an error.
    return within(code, 301, 305) && setMode(code, arguments[0]);
}

bool RobotApplication::refuse(ErrorCode error) noexcept {
    error_ = error;
    return false;
}

// ---- motions -----------------------------------------------------------------------------------

bool RobotApplication::moveJoints(const Arguments& arguments) {
    auto target = cabinet_.arm.position();
    for (std::size_t axis = 0; axis < target.size(); ++axis) {
        const auto& most = cabinet_.arm.model().limits(axis);
        if (within(arguments[axis], most.lower, most.upper)) {
            target[axis] = arguments[axis];
        }
    }
    if (!servo_) {
        return moveStandard(
            [&model = cabinet_.arm.model(), target, limits = limits_](const JointVector& start) {
                return planPtp(model, start, target, limits);
            });
    }
    if (!servoAllowed()) {
        return false;
    }
    cabinet_.arm.servoTo(target, limits_);
    return true;
}

bool RobotApplication::movePose(const Arguments& arguments) {
    if (motion_type_ != kPtp && motion_type_ != kLin) {
        return false;
    }
    auto numbers = toNumbers(pose());
    for (std::size_t i = 0; i < numbers.size(); ++i) {
        numbers[i] = std::isnan(arguments[i]) ? numbers[i] : arguments[i];
    }
    const bool linear = motion_type_ == kLin;
    const auto target = toPose(numbers);
    if (!servo_) {
        return moveStandard(
            [moved = frame(), target, limits = limits_, linear](const JointVector& start) {
                return linear ? planLinear(moved, start, target, limits)
                              : planPtp(moved, start, target, limits);
            });
    }
    if (!servoAllowed()) {
        return false;
    }
    if (linear) {
        cabinet_.arm.servoTo(frame(), target, limits_);
        return true;
    }
    const auto joints = cabinet_.arm.model().kinematics().inverse(
        target * flange_from_tool_.inverse(), {cabinet_.arm.position(), {}, {}});
    if (!joints) {
        return refuse(ErrorCode::asynchronous_motion);
    }
    cabinet_.arm.servoTo(*joints, limits_);
    return true;
}

bool RobotApplication::moveCircle(const Arguments& arguments) {
    if (servo_) {
        return refuse(ErrorCode::configuration);
    }
    const CirclePoints points{
        kMillimetre * Eigen::Vector3d(arguments[0], arguments[1], arguments[2]),
        kMillimetre * Eigen::Vector3d(arguments[3], arguments[4], arguments[5])};
    return moveStandard([moved = frame(), points, limits = limits_](const JointVector& start) {
        return planCircle(moved, start, points, limits);
    });
}

bool RobotApplication::moveStandard(Arm::Plan plan) {
    if (!cabinet_.ready()) {
        return false;
    }
    fired_ = false;
    asked_to_move_ = true;
    cabinet_.arm.move(std::move(plan));
    return true;
}

bool RobotApplication::servoAllowed() {
    return synchronous_ ? refuse(ErrorCode::configuration) : cabinet_.ready();
}

// ---- settings ----------------------------------------------------------------------------------

bool RobotApplication::setLimit(int code, double value) {
    if (code <= 203 ? !within(value, 0.0, 1.0) : !(value > 0.0 && std::isfinite(value))) {
        return refuse(ErrorCode::value);
    }
    constexpr std::array kLimits{&MotionLimits::joint_velocity, &MotionLimits::joint_acceleration,
                                 &MotionLimits::joint_jerk,     &MotionLimits::velocity,
                                 &MotionLimits::acceleration,   &MotionLimits::jerk};
    limits_.*kLimits.at(static_cast<std::size_t>(code - 201)) =
        code <= 203 ? value : value * kMillimetre;
    return true;
}

bool RobotApplication::setForceCondition(const Arguments& arguments) {
    bool taken = true;
    for (std::size_t axis = 0; axis < force_thresholds_.size(); ++axis) {
        const double threshold = arguments[axis];
        const double tolerance = arguments[axis + 3];
        force_thresholds_[axis].reset();
        if (std::isnan(threshold) || std::isnan(tolerance)) {
            continue;
        }
        if (threshold < 0.0 || tolerance <= 0.0) {
            taken = refuse(ErrorCode::value);
        } else {
            force_thresholds_[axis] = threshold;
        }
    }
    return taken;
}

bool RobotApplication::setTorqueCondition(const Arguments& arguments) {
    auto& limits = torque_limits_.at(static_cast<std::size_t>(rounded(arguments[0])));
    const double lower = arguments[1];
    const double upper = arguments[2];
    limits.reset();
    if (std::isnan(lower) || std::isnan(upper)) {
        return true;
    }
    if (!(lower < upper)) {
        return refuse(ErrorCode::value);
    }
    limits = Interval{lower, upper};
    return true;
}

bool RobotApplication::setMode(int code, double value) {
    const auto* const choice = std::ranges::find(kChoices, code, &Choice::command);
    if (!isWhole(value) || !within(value, choice->first, choice->last)) {
        // Command 301 (when the state is sent) with an unknown value is refused without an error
        // code.
        return code != 301 && refuse(ErrorCode::value);
    }
    const int chosen = static_cast<int>(value);
    switch (code) {
        case 301:
            silent_ = chosen == kPeriodical;
            break;
        case 302:
            servo_ = chosen == kServoInterface;
            break;
        case 303:
            motion_type_ = chosen;
            break;
        case 304:
            control_mode_ = chosen;
            break;
        default:
            synchronous_ = chosen == kSynchronous;
    }
    return true;
}

void RobotApplication::setImpedance(int code, const Arguments& arguments) {
    auto& setting = impedance_[code];
    setting = impedanceAfter(code, setting, arguments);
}

bool RobotApplication::attachTool(double index) {
    const auto& tools = cabinet_.arm.model().chain().tools;
    if (!isWhole(index) || index < -1.0 || index >= static_cast<double>(tools.size())) {
        return refuse(ErrorCode::value);
    }
    flange_from_tool_ =
        index < 0.0 ? Pose{} : tools[static_cast<std::size_t>(index)].flange_from_tool;
    return true;
}

// ---- while it runs -----------------------------------------------------------------------------

void RobotApplication::step(std::optional<Arm::End> end) {
    if (cabinet_.arm.running() && conditionHolds()) {
        fired_ = true;
        cabinet_.arm.brake(Arm::End::done);
    }
    if (!end) {
        return;
    }
    const bool failed = *end == Arm::End::failed || (waiting_ && *end == Arm::End::cancelled);
    if (failed) {
        fail();
    }
    waiting_ = false;
}

void RobotApplication::fail() noexcept {
    error_ = waiting_ ? ErrorCode::synchronous_motion : ErrorCode::asynchronous_motion;
    status_ = status_ && !waiting_;
}

bool RobotApplication::conditionHolds() const {
    for (std::size_t axis = 0; axis < force_thresholds_.size(); ++axis) {
        const auto& threshold = force_thresholds_[axis];
        const double force = cabinet_.wrench.force[static_cast<Eigen::Index>(axis)];
        if (threshold && std::abs(force) > *threshold) {
            return true;
        }
    }
    const auto torque = cabinet_.externalTorque();
    for (std::size_t axis = 0; axis < torque.size(); ++axis) {
        const auto& limits = torque_limits_[axis];
        if (limits && !within(torque[axis], limits->lower, limits->upper)) {
            return true;
        }
    }
    return false;
}

MovingFrame RobotApplication::frame() const {
    return {&cabinet_.arm.model(), flange_from_tool_};
}

Pose RobotApplication::pose() const {
    return cabinet_.arm.model().kinematics().forward(cabinet_.arm.position()) * flange_from_tool_;
}

StateNumbers RobotApplication::state() const {
    StateNumbers state{};
    const auto put = [&state](std::size_t first, const auto& values) {
        std::copy(values.begin(), values.end(), state.begin() + static_cast<std::ptrdiff_t>(first));
    };
    const auto& wrench = cabinet_.wrench;
    state[state_index::kStatus] = status_ ? 1.0 : 0.0;
    put(state_index::kJointPosition, cabinet_.arm.position());
    put(state_index::kJointVelocity, cabinet_.arm.velocity());
    put(state_index::kJointTorque, cabinet_.externalTorque());
    put(state_index::kPosition, toNumbers(pose()));
    put(state_index::kForce, std::array{wrench.force.x(), wrench.force.y(), wrench.force.z()});
    put(state_index::kTorque, std::array{wrench.torque.x(), wrench.torque.y(), wrench.torque.z()});
    state[state_index::kError] = static_cast<double>(error_);
    state[state_index::kConditionFired] = fired_ ? 1.0 : 0.0;
    state[state_index::kReady] = cabinet_.ready() ? 1.0 : 0.0;
    state[state_index::kMoving] = cabinet_.arm.moving() ? 1.0 : 0.0;
    return state;
}

}  // namespace metier::virtual_iiwa
