#include "moves/settling.hpp"

#include <fmt/format.h>

namespace metier::robot_skills {

namespace {

// The measured arm has arrived when each axis is this near its set-point [rad].
constexpr double kArrived = 1e-3;
// The first cycle may still show an arm that has not begun a short way, as after a late Suspend.
constexpr int kArrivedCycles = 2;
// Longest time for that after the last set-point [s], and longest rest elsewhere, since news of a
// motion may be late [s].
constexpr double kLongestSettling = 10.0;
constexpr double kLongestRest = 2.0;

}  // namespace

Settling::Status Settling::take(const device::ArmState& state, const device::JointArray& target,
                                double cycle) noexcept {
    distance_ = device::largestDifference(state.position, target);
    arrived_cycles_ = state.standstill && distance_ < kArrived ? arrived_cycles_ + 1 : 0;
    if (arrived_cycles_ >= kArrivedCycles) {
        return Status::arrived;
    }
    waited_ += cycle;
    rested_ = state.standstill ? rested_ + cycle : 0.0;
    return waited_ > kLongestSettling || rested_ > kLongestRest ? Status::off_target
                                                                : Status::waiting;
}

void Settling::tellOffTarget(const skill::ExecutionHandle& execution) const {
    execution.fail(skill::Reason::error,
                   fmt::format("the arm {} {:.4f} rad off its set-point {:.1f} s after the motion, "
                               "limit {} rad",
                               rested_ > kLongestRest ? "rests" : "still moves", distance_, waited_,
                               kArrived));
}

}  // namespace metier::robot_skills
