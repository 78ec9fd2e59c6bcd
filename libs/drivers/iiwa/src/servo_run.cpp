#include "servo_run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "commands.hpp"
#include "controller_planned_run.hpp"

namespace metier::iiwa_driver {

using Kind = ServoFault::Kind;

namespace {

// Rounding of set-points at the end of an axis' range [rad].
constexpr double kJointRounding = 1e-6;
// Largest step to a set-point, as a multiple of the way that the axis can go in one cycle.
constexpr double kStepFactor = 1.5;
constexpr double kSmallStep = 1e-3;  // [rad]
// The arm may be this far behind its set-points for so long: at full speed it is some 50 ms behind.
constexpr double kLargestLag = 0.2;     // [rad]
constexpr double kLongestBehind = 0.3;  // [s]

}  // namespace

std::string toString(const ServoFault& fault) {
    const auto axis = fault.axis + 1;
    switch (fault.kind) {
        case Kind::position:
            return fmt::format("axis {}: set-point {:.4f} rad beyond limit {:.4f} rad", axis,
                               fault.value, fault.limit);
        case Kind::step:
            return fmt::format(
                "axis {}: set-point {:.4f} rad from the one before, limit {:.4f} "
                "rad in a cycle",
                axis, fault.value, fault.limit);
        case Kind::not_finite:
            return fmt::format("axis {}: set-point is not finite", axis);
        case Kind::not_following:
            return fmt::format("axis {} is {:.4f} rad from its set-point, limit {:.4f} rad", axis,
                               fault.value, fault.limit);
        case Kind::refused:
            return "the cabinet refused: " + describe(fault.command);
    }
    return "the stream failed";
}

void ServoRun::begin(const device::JointArray& start, const CabinetSettings& settings) noexcept {
    *this = ServoRun(*model_, cycle_);
    commanded_ = start;
    settings.require(jointVelocity(1.0), list_);
    settings.require(jointAcceleration(1.0), list_);
    settings.require(chooseInterface(Interface::servo), list_);
    phase_ = list_.empty() ? Phase::following : Phase::entering;
}

void ServoRun::stop() noexcept {
    if (phase_ != Phase::faulty) {
        phase_ = Phase::stopping;
    }
}

Command ServoRun::command(device::SetPointSource& source, const device::ArmState& state,
                          int cycles) noexcept {
    switch (phase_) {
        case Phase::entering:
            return list_.front();
        case Phase::following:
            return follow(source, state, cycles);
        case Phase::done:
            return askState();
        case Phase::faulty:
        case Phase::stopping:
            return cancelled_ ? askState() : cancel();
    }
    return askState();
}

/// Each set-point is judged against the one before, also those that are left out.
Command ServoRun::follow(device::SetPointSource& source, const device::ArmState& state,
                         int cycles) noexcept {
    for (int i = 0; i < cycles; ++i) {
        auto set_point = commanded_;
        if (source.next(state, set_point) == device::SetPointSource::Next::done) {
            phase_ = Phase::done;
            return moveJoints(commanded_);
        }
        if (!accept(set_point)) {
            return cancel();
        }
    }
    return moveJoints(commanded_);
}

bool ServoRun::refuse(const ServoFault& fault) noexcept {
    fault_ = fault;
    phase_ = Phase::faulty;
    return false;
}

bool ServoRun::accept(const device::JointArray& set_point) noexcept {
    for (std::size_t axis = 0; axis < kAxes; ++axis) {
        const double value = set_point[axis];
        const auto& limits = model_->limits(axis);
        if (!std::isfinite(value)) {
            return refuse({Kind::not_finite, axis, value, 0.0, {}});
        }
        const double within = std::clamp(value, limits.lower, limits.upper);
        if (std::abs(value - within) > kJointRounding) {
            return refuse({Kind::position, axis, value, within, {}});
        }
        const double longest = kStepFactor * limits.velocity * cycle_ + kSmallStep;
        if (const double step = std::abs(value - commanded_[axis]); step > longest) {
            return refuse({Kind::step, axis, step, longest, {}});
        }
    }
    commanded_ = set_point;
    return true;
}

ServoRun::Status ServoRun::take(const Command& sent, const CabinetState& answer, double step,
                                CabinetSettings& settings) noexcept {
    cancelled_ = cancelled_ || sent.code == Code::cancel;
    switch (phase_) {
        case Phase::entering:
            return enter(sent, answer, settings);
        case Phase::following:
            if (sent.code == Code::move_joints && !answer.executed) {
                refuse({Kind::refused, 0, 0.0, 0.0, sent});
            } else if (!follows(answer, step)) {
                phase_ = Phase::faulty;
            }
            return Status::running;
        case Phase::done:
            return Status::done;
        case Phase::faulty:
        case Phase::stopping:
            return rest(answer);
    }
    return Status::running;
}

ServoRun::Status ServoRun::enter(const Command& sent, const CabinetState& answer,
                                 CabinetSettings& settings) noexcept {
    if (!answer.executed) {
        settings.refused(sent);
        refuse({Kind::refused, 0, 0.0, 0.0, sent});
        return Status::running;
    }
    settings.taken(sent);
    list_.drop();
    if (list_.empty()) {
        phase_ = Phase::following;
    }
    return Status::running;
}

bool ServoRun::follows(const CabinetState& answer, double step) noexcept {
    std::size_t worst = 0;
    for (std::size_t axis = 1; axis < kAxes; ++axis) {
        if (std::abs(answer.position[axis] - commanded_[axis]) >
            std::abs(answer.position[worst] - commanded_[worst])) {
            worst = axis;
        }
    }
    const double distance = std::abs(answer.position[worst] - commanded_[worst]);
    behind_ = distance > kLargestLag ? behind_ + step : 0.0;
    if (behind_ <= kLongestBehind) {
        return true;
    }
    fault_ = {Kind::not_following, worst, distance, kLargestLag, {}};
    return false;
}

ServoRun::Status ServoRun::rest(const CabinetState& answer) const noexcept {
    if (!cancelled_ || !stands(answer)) {
        return Status::running;
    }
    return phase_ == Phase::faulty ? Status::fault : Status::stopped;
}

}  // namespace metier::iiwa_driver
