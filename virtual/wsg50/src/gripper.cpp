#include "gripper.hpp"

#include <algorithm>
#include <utility>

namespace metier::virtual_wsg50 {

namespace {

// Half of the resolution of the wire's float at the ends of the ranges [m], [m/s], ...
constexpr double kRounding = 1e-6;

/// Range check; false for NaN, too.
bool within(double value, double low, double high) {
    return value >= low - kRounding && value <= high + kRounding;
}

}  // namespace

Gripper::Gripper(const Capability& capability, OnFinished on_finished)
    : capability_(capability),
      on_finished_(std::move(on_finished)),
      jaws_(capability.stroke, capability.start_width),
      force_limit_(capability.nominal_force) {}

// ---- motions -----------------------------------------------------------------------------------

Status Gripper::home(HomingDirection direction) {
    if (fault()) {
        return Status::access_denied;
    }
    const double end = direction == HomingDirection::negative ? 0.0 : capability_.stroke;
    const auto status = begin({Command::home}, end, capability_.homing_speed);
    referenced_ = false;
    state_ = GraspingState::positioning;
    return status;
}

Status Gripper::prePosition(double target, double speed, WhenBlocked when_blocked) {
    if (const auto refused = permit(target, speed); refused != Status::success) {
        return refused;
    }
    const auto status = begin({Command::pre_position, 0.0, when_blocked}, target, speed);
    state_ = GraspingState::positioning;
    return status;
}

Status Gripper::grasp(double nominal_width, double speed) {
    if (const auto refused = permit(nominal_width, speed); refused != Status::success) {
        return refused;
    }
    const auto limits = softLimits();
    const bool closing = jaws_.width() > nominal_width - capability_.clamping_travel;
    const double beyond = closing ? -capability_.clamping_travel : capability_.clamping_travel;
    const double target = std::clamp(nominal_width + beyond, limits.minus, limits.plus);
    ++cycles_;
    ++cycles_since_reset_;
    const auto status = begin({Command::grasp, nominal_width}, target, speed);
    state_ = GraspingState::grasping;
    return status;
}

Status Gripper::release(double opening_width, double speed) {
    if (const auto refused = permit(opening_width, speed); refused != Status::success) {
        return refused;
    }
    const auto status = begin({Command::release}, opening_width, speed);
    state_ = GraspingState::releasing;
    return status;
}

Status Gripper::permit(double width, double speed) const {
    if (fault()) {
        return Status::access_denied;
    }
    if (!referenced_) {
        return Status::not_initialised;
    }
    const auto limits = softLimits();
    const bool possible = within(width, limits.minus, limits.plus) &&
                          within(speed, capability_.min_speed, capability_.max_speed);
    return possible ? Status::success : Status::range_error;
}

Status Gripper::begin(const Motion& motion, double target, double speed) {
    abort();
    motion_ = motion;
    axis_stopped_ = false;
    blocked_ = Jaws::Contact::none;
    target_reached_ = false;
    jaws_.moveTo(target, speed);
    return Status::pending;
}

void Gripper::abort() {
    if (motion_) {
        ++aborted_since_reset_;
        finish(Status::command_aborted, GraspingState::idle);
    }
}

void Gripper::finish(Status status, GraspingState state) {
    const auto ended = std::exchange(motion_, std::nullopt);
    state_ = state;
    on_finished_(ended->command, status);
}

void Gripper::stop() {
    if (jaws_.contact() == Jaws::Contact::none) {
        jaws_.brake();
    }
    axis_stopped_ = true;
    abort();
}

void Gripper::fastStop() {
    if (jaws_.contact() == Jaws::Contact::none) {
        jaws_.halt();
    }
    fast_stop_ = true;
    abort();
}

void Gripper::step(double seconds, const Obstacles& obstacles) {
    jaws_.step(seconds, obstacles);
    if (!motion_) {
        watchPart();
    } else if (jaws_.contact() != Jaws::Contact::none) {
        meet();
    } else if (jaws_.arrived()) {
        arrive();
    }
}

void Gripper::arrive() {
    target_reached_ = true;
    switch (motion_->command) {
        case Command::grasp:
            finish(Status::command_failed, GraspingState::no_part);
            break;
        case Command::home:
            referenced_ = true;
            [[fallthrough]];
        default:
            finish(Status::success, GraspingState::idle);
    }
}

void Gripper::meet() {
    const auto motion = *motion_;
    if (motion.command == Command::grasp &&
        jaws_.width() <= motion.nominal + capability_.clamping_travel + kRounding) {
        finish(Status::success, GraspingState::holding);
        return;
    }
    if (motion.when_blocked == WhenBlocked::stop) {
        axis_stopped_ = true;
        blocked_ = jaws_.contact();
        jaws_.halt();
    }
    finish(Status::axis_blocked, GraspingState::error);
}

void Gripper::watchPart() {
    if (state_ == GraspingState::holding && jaws_.contact() == Jaws::Contact::none) {
        state_ = GraspingState::part_lost;
    }
}

// ---- settings and faults -----------------------------------------------------------------------

void Gripper::acknowledge() {
    fast_stop_ = false;
    temperature_fault_ = hot_;
    if (state_ == GraspingState::error) {
        state_ = GraspingState::idle;
    }
}

Status Gripper::setAcceleration(double acceleration) {
    if (!within(acceleration, capability_.min_acceleration, capability_.max_acceleration)) {
        return Status::range_error;
    }
    jaws_.acceleration = acceleration;
    return Status::success;
}

Status Gripper::setForceLimit(double force) {
    const double most = overdrive_ ? capability_.overdrive_force : capability_.nominal_force;
    if (!within(force, capability_.min_force, most)) {
        return Status::range_error;
    }
    force_limit_ = force;
    return Status::success;
}

Status Gripper::setSoftLimits(SoftLimits limits) {
    if (!within(limits.minus, 0.0, capability_.stroke) ||
        !within(limits.plus, 0.0, capability_.stroke) || !(limits.minus < limits.plus)) {
        return Status::range_error;
    }
    soft_limits_ = limits;
    return Status::success;
}

void Gripper::setOverdrive(bool on) {
    overdrive_ = on;
    if (!on) {
        force_limit_ = std::min(force_limit_, capability_.nominal_force);
    }
}

void Gripper::setTemperatureFault(bool present) {
    hot_ = present;
    if (present) {
        temperature_fault_ = true;
        jaws_.halt();
        abort();
        state_ = GraspingState::error;
    }
}

// ---- what can be asked -------------------------------------------------------------------------

double Gripper::force() const noexcept {
    return jaws_.contact() == Jaws::Contact::none ? 0.0 : force_limit_;
}

SoftLimits Gripper::softLimits() const noexcept {
    return soft_limits_.value_or(SoftLimits{0.0, capability_.stroke});
}

std::uint32_t Gripper::systemState() const noexcept {
    const auto bit = [](bool set, std::uint32_t mask) { return set ? mask : 0U; };
    const auto contact = jaws_.contact() == Jaws::Contact::none ? blocked_ : jaws_.contact();
    const bool limited = soft_limits_.has_value();
    return bit(referenced_, system_bit::kReferenced) |
           bit(jaws_.velocity() != 0.0, system_bit::kMoving) |
           bit(contact == Jaws::Contact::closing, system_bit::kBlockedMinus) |
           bit(contact == Jaws::Contact::opening, system_bit::kBlockedPlus) |
           bit(limited && jaws_.width() <= softLimits().minus, system_bit::kSoftLimitMinus) |
           bit(limited && jaws_.width() >= softLimits().plus, system_bit::kSoftLimitPlus) |
           bit(axis_stopped_, system_bit::kAxisStopped) |
           bit(target_reached_, system_bit::kTargetReached) |
           bit(overdrive_, system_bit::kOverdrive) | bit(fast_stop_, system_bit::kFastStop) |
           bit(temperature_fault_, system_bit::kTemperatureFault);
}

}  // namespace metier::virtual_wsg50
