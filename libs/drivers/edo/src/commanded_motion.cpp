#include "commanded_motion.hpp"

#include <algorithm>
#include <cmath>

namespace metier::edo_driver {
namespace {

const double kCycleSeconds = std::chrono::duration<double>(EdoOptions::kCycle).count();
// A planned motion keeps to the velocity; so much over it only a jump is.
constexpr double kStepReserve = 1.5;
// Targets up to so far outside are clamped by the robot itself [rad].
constexpr double kPositionReserve = 0.0035;
// A measurement of a standing joint may vary by it [rad].
constexpr double kNoise = 1e-3;

}  // namespace

std::string toText(const Violation& violation) {
    const auto axis = violation.axis + 1;
    switch (violation.kind) {
        case Violation::Kind::axis_count:
            return fmt::format("a set-point of {} axes instead of {}", violation.value,
                               violation.limit);
        case Violation::Kind::not_finite:
            return fmt::format("axis {}: a set-point that is no number", axis);
        case Violation::Kind::position:
            return fmt::format("axis {}: set-point {:.4f} rad beyond its limit {:.4f} rad", axis,
                               violation.value, violation.limit);
        case Violation::Kind::step:
            return fmt::format("axis {}: set-point at {:.4f} rad/s over its limit {:.4f} rad/s",
                               axis, violation.value, violation.limit);
    }
    return "a set-point that is not acceptable";
}

CommandedMotion::CommandedMotion(const AxisOptions& axes)
    : axes_(axes), position_(axes.size()), velocity_(axes.size()) {}

void CommandedMotion::reset(const device::JointArray& position) noexcept {
    position_ = position;
    hold();
}

void CommandedMotion::settle(const device::JointArray& measured) noexcept {
    if (device::largestDifference(position_, measured) > kNoise || !standing()) {
        reset(measured);
    }
}

std::optional<Violation> CommandedMotion::accept(const device::JointArray& set_point) noexcept {
    if (set_point.size() != position_.size()) {
        return Violation{Violation::Kind::axis_count, 0, static_cast<double>(set_point.size()),
                         static_cast<double>(position_.size())};
    }
    for (std::size_t axis = 0; axis < position_.size(); ++axis) {
        if (const auto violation = check(axis, set_point[axis])) {
            return violation;
        }
    }
    for (std::size_t axis = 0; axis < position_.size(); ++axis) {
        velocity_[axis] = (set_point[axis] - position_[axis]) / kCycleSeconds;
        position_[axis] = set_point[axis];
    }
    return std::nullopt;
}

std::optional<Violation> CommandedMotion::check(std::size_t axis, double position) const noexcept {
    if (!std::isfinite(position)) {
        return Violation{Violation::Kind::not_finite, axis, position, 0.0};
    }
    const double speed = (position - position_[axis]) / kCycleSeconds;
    if (std::abs(speed) > kStepReserve * axes_[axis].velocity) {
        return Violation{Violation::Kind::step, axis, speed, axes_[axis].velocity};
    }
    const bool outward = speed > 0.0 ? position > axes_[axis].upper + kPositionReserve
                                     : position < axes_[axis].lower - kPositionReserve;
    if (outward && speed != 0.0) {
        return Violation{Violation::Kind::position, axis, position,
                         speed > 0.0 ? axes_[axis].upper : axes_[axis].lower};
    }
    return std::nullopt;
}

void CommandedMotion::hold() noexcept {
    std::fill(velocity_.begin(), velocity_.end(), 0.0);
}

void CommandedMotion::brake() noexcept {
    for (std::size_t axis = 0; axis < position_.size(); ++axis) {
        const double change = axes_[axis].acceleration * kCycleSeconds;
        auto& velocity = velocity_[axis];
        velocity = std::abs(velocity) <= change ? 0.0 : velocity - std::copysign(change, velocity);
        position_[axis] += velocity * kCycleSeconds;
    }
}

bool CommandedMotion::standing() const noexcept {
    return std::all_of(velocity_.begin(), velocity_.end(), [](double v) { return v == 0.0; });
}

std::optional<FollowingWatch::Lag> FollowingWatch::check(const device::JointArray& commanded,
                                                         const device::JointArray& measured,
                                                         SteadyTime now) noexcept {
    Lag lag;
    for (std::size_t axis = 0; axis < commanded.size(); ++axis) {
        const double distance = std::abs(commanded[axis] - measured[axis]);
        if (distance > lag.distance) {
            lag = {axis, distance};
        }
    }
    if (lag.distance <= options_.distance) {
        behind_since_.reset();
        return std::nullopt;
    }
    behind_since_ = behind_since_.value_or(now);
    return now - *behind_since_ >= options_.time ? std::optional(lag) : std::nullopt;
}

bool Pacer::due(SteadyTime now) noexcept {
    if (now + cycle_ / 2 < next_) {
        return false;
    }
    next_ = std::max(next_, now) + cycle_;
    return true;
}

}  // namespace metier::edo_driver
