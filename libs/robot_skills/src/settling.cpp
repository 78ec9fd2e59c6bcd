#include "settling.hpp"

#include <fmt/format.h>

namespace metier::robot_skills {

namespace {

// The measured arm has arrived when each axis is this near its set-point [rad].
constexpr double kArrived = 1e-3;
// How long it may take for that after the last set-point, and how long rest elsewhere, which may be
// late news of a motion [s].
constexpr double kLongest = 10.0;
constexpr double kLongestRest = 2.0;

}  // namespace

Settling::Status Settling::take(const device::ArmState& state, const device::JointArray& target,
                                double cycle) noexcept {
    distance_ = device::largestDifference(state.position, target);
    if (state.standstill && distance_ < kArrived) {
        return Status::arrived;
    }
    waited_ += cycle;
    rested_ = state.standstill ? rested_ + cycle : 0.0;
    return waited_ > kLongest || rested_ > kLongestRest ? Status::off_target : Status::waiting;
}

void Settling::tellOffTarget(const skill::Execution& execution) const {
    execution.fail(skill::Reason::error,
                   fmt::format("the arm {} {:.4f} rad off its set-point {:.1f} s after the motion, "
                               "limit {} rad",
                               rested_ > kLongestRest ? "rests" : "still moves", distance_, waited_,
                               kArrived));
}

}  // namespace metier::robot_skills
