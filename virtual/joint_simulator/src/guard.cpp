#include "metier/joint_simulator/guard.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace metier::joint_simulator {

using Quantity = Violation::Quantity;

std::string toText(const Violation& violation) {
    const auto axis = violation.axis + 1;
    switch (violation.quantity) {
        case Quantity::position:
            return fmt::format("axis {}: position {:.4f} rad beyond limit {:.4f} rad", axis,
                               violation.value, violation.limit);
        case Quantity::velocity:
            return fmt::format("axis {}: velocity {:.4f} rad/s over limit {:.4f} rad/s", axis,
                               violation.value, violation.limit);
        case Quantity::acceleration:
            return fmt::format("axis {}: acceleration {:.4f} rad/s2 over limit {:.4f} rad/s2", axis,
                               violation.value, violation.limit);
        case Quantity::not_finite:
            return fmt::format("axis {}: set-point is not finite", axis);
        case Quantity::axis_count:
            return fmt::format("set-point has {} values, the arm has {} axes", violation.value,
                               violation.limit);
    }
    return "unknown violation";
}

Guard::Guard(std::vector<AxisLimits> limits, GuardTolerance tolerance, double cycle)
    : limits_(std::move(limits)),
      tolerance_(tolerance),
      cycle_(cycle),
      position_(limits_.size()),
      velocity_(limits_.size()) {}

std::optional<Violation> Guard::accept(const device::JointArray& set_point) noexcept {
    if (set_point.size() != limits_.size()) {
        return Violation{Quantity::axis_count, 0, static_cast<double>(set_point.size()),
                         static_cast<double>(limits_.size())};
    }
    device::JointArray velocity(limits_.size());
    for (std::size_t axis = 0; axis < limits_.size(); ++axis) {
        velocity[axis] = (set_point[axis] - position_[axis]) / cycle_;
        if (auto violation = check(axis, set_point[axis], velocity[axis])) {
            return violation;
        }
    }
    position_ = set_point;
    velocity_ = velocity;
    return std::nullopt;
}

std::optional<Violation> Guard::check(std::size_t axis, double position,
                                      double velocity) const noexcept {
    const auto& limits = limits_[axis];
    if (!std::isfinite(position)) {
        return Violation{Quantity::not_finite, axis, position, 0.0};
    }
    if (position < limits.lower - tolerance_.position) {
        return Violation{Quantity::position, axis, position, limits.lower};
    }
    if (position > limits.upper + tolerance_.position) {
        return Violation{Quantity::position, axis, position, limits.upper};
    }
    if (std::abs(velocity) > limits.velocity * (1.0 + tolerance_.velocity)) {
        return Violation{Quantity::velocity, axis, std::abs(velocity), limits.velocity};
    }
    const double acceleration = std::abs(velocity - velocity_[axis]) / cycle_;
    if (acceleration > limits.acceleration * (1.0 + tolerance_.acceleration)) {
        return Violation{Quantity::acceleration, axis, acceleration, limits.acceleration};
    }
    return std::nullopt;
}

const device::JointArray& Guard::brake() noexcept {
    for (std::size_t axis = 0; axis < limits_.size(); ++axis) {
        const double step = limits_[axis].acceleration * cycle_;
        velocity_[axis] -= std::clamp(velocity_[axis], -step, step);
        position_[axis] += velocity_[axis] * cycle_;
    }
    return position_;
}

void Guard::reset(const device::JointArray& position) noexcept {
    position_ = position;
    velocity_ = device::JointArray(limits_.size());
}

bool Guard::standing() const noexcept {
    return std::all_of(velocity_.begin(), velocity_.end(), [](double v) { return v == 0.0; });
}

}  // namespace metier::joint_simulator
