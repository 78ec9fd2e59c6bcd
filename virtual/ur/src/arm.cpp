#include "arm.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "metier/device/joint_array.hpp"

namespace metier::virtual_ur {

namespace {

// Speed below which the arm stands still: rounding errors of a standstill are smaller [rad/s].
constexpr double kStandstill = 1e-9;
// Distance of an injected violation beyond a limit [rad].
constexpr double kBeyond = 0.01;

// Codes of the maker's list of errors (assumed): position close to joint limits, position deviates
// from path, position in singularity.
constexpr int kJointLimit = 150;
constexpr int kOffPath = 153;
constexpr int kSingularity = 154;

constexpr std::size_t kHistory = 1000;
constexpr std::size_t kDelayCycles = 1;

device::JointArray toArray(const Vector6& values) {
    return device::JointArray(std::span(values));
}

ArmViolation toViolation(const joint_simulator::Violation& violation) {
    const bool position = violation.quantity == joint_simulator::Violation::Quantity::position;
    return {position ? kJointLimit : kOffPath, toText(violation)};
}

/// Stops the arm, then begins.
class AfterStop final : public Motion {
public:
    AfterStop(Arm::FromStandstill make, double acceleration)
        : make_(std::move(make)), motion_(stopJ(acceleration)) {}

    std::optional<Vector6> next(const JointState& now, double step) override {
        if (!begun_ && now.velocity == Vector6{}) {
            motion_ = make_(now.position);
            begun_ = true;
        }
        return motion_->next(now, step);
    }
    bool done() const override { return begun_ && motion_->done(); }

private:
    Arm::FromStandstill make_;
    std::unique_ptr<Motion> motion_;
    bool begun_ = false;
};

}  // namespace

Arm::Arm(const motion::RobotModel& model, const ArmOptions& options)
    : model_(model),
      options_(options),
      guard_(options.limits, joint_simulator::GuardTolerance{}, options.cycle),
      lag_(kDelayCycles, 0.0, options.cycle) {
    reset(options.start);
}

void Arm::reset(const Vector6& position) {
    forget();
    braking_ = false;
    target_ = {position, {}};
    acceleration_ = {};
    guard_.reset(toArray(position));
    lag_.reset(toArray(position));
    history_.assign(1, position);
}

void Arm::servo(const Vector6& target, double duration, double lag) {
    if (braking_) {
        return;
    }
    if (servo_ == nullptr) {
        auto motion = std::make_unique<ServoMotion>(target_);
        auto* const servo = motion.get();
        begin(std::move(motion));
        servo_ = servo;
    }
    servo_->retarget(target, duration, lag);
}

void Arm::servoLine(const motion::Pose& base_from_target, const PathSpeed& speed) {
    if (braking_) {
        return;
    }
    if (line_servo_ == nullptr) {
        auto motion = std::make_unique<LineServo>(target_);
        auto* const servo = motion.get();
        begin(std::move(motion));
        line_servo_ = servo;
    }
    line_servo_->retarget(base_from_target, speed, tool());
}

void Arm::begin(std::unique_ptr<Motion> motion) {
    if (!braking_) {
        forget();
        motion_ = std::move(motion);
    }
}

void Arm::forget() {
    motion_.reset();
    servo_ = nullptr;
    line_servo_ = nullptr;
}

void Arm::beginStanding(FromStandstill motion, double stop_acceleration) {
    begin(std::make_unique<AfterStop>(std::move(motion), stop_acceleration));
}

void Arm::brake() {
    begin(stopJ(options_.stop_deceleration));
    braking_ = true;
}

bool Arm::standing() const {
    return target_.velocity == Vector6{};
}

std::optional<ArmViolation> Arm::cycle(double scaling) {
    auto violation = follow(braking_ ? options_.cycle : options_.cycle * scaling);
    if (violation) {
        brake();
        follow(options_.cycle);
    }
    lag_.advance(toArray(target_.position));
    history_.push_front(toVector6(lag_.position()));
    if (history_.size() > kHistory) {
        history_.pop_back();
    }
    return violation;
}

std::optional<ArmViolation> Arm::follow(double step) {
    if (!motion_ || step <= 0.0) {
        take(target_.position);
        return std::nullopt;
    }
    const auto next = motion_->next(target_, step);
    if (!next) {
        return ArmViolation{kSingularity, "the line passes where the axes cannot follow"};
    }
    if (!braking_) {
        if (const auto violation = guard_.accept(toArray(*next))) {
            return toViolation(*violation);
        }
    }
    take(*next);
    if (motion_->done() && standing()) {
        if (braking_) {
            guard_.reset(toArray(target_.position));
        }
        forget();
        braking_ = false;
    }
    return std::nullopt;
}

void Arm::take(const Vector6& position) {
    for (std::size_t i = 0; i < kAxes; ++i) {
        const double velocity = (position[i] - target_.position[i]) / options_.cycle;
        const double taken = std::abs(velocity) < kStandstill ? 0.0 : velocity;
        acceleration_[i] = (taken - target_.velocity[i]) / options_.cycle;
        target_.velocity[i] = taken;
    }
    target_.position = position;
}

ArmViolation Arm::beyondLimit(std::size_t axis) const {
    const double limit = options_.limits[axis].upper;
    return toViolation(
        {joint_simulator::Violation::Quantity::position, axis, limit + kBeyond, limit});
}

bool Arm::withinLimits(const Vector6& position) const {
    for (std::size_t i = 0; i < kAxes; ++i) {
        if (!(position[i] >= options_.limits[i].lower && position[i] <= options_.limits[i].upper)) {
            return false;
        }
    }
    return true;
}

JointState Arm::actual() const {
    return {toVector6(lag_.position()), toVector6(lag_.velocity())};
}

std::optional<Vector6> Arm::history(std::size_t cycles) const {
    if (cycles >= history_.size()) {
        return cycles < kHistory ? std::optional(history_.back()) : std::nullopt;
    }
    return history_[cycles];
}

}  // namespace metier::virtual_ur
