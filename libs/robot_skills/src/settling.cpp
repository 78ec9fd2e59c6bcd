#include "settling.hpp"

#include <fmt/format.h>

namespace metier::robot_skills {

namespace {

// The measured arm has arrived when each axis is this near its set-point [rad].
constexpr double kArrived = 1e-3;
// How long it may take for that after the last set-point [s].
constexpr double kLongest = 1.0;

}  // namespace

Settling::Status Settling::take(const device::ArmState& state, const device::JointArray& target,
                                double cycle) noexcept {
    distance_ = device::largestDifference(state.position, target);
    if (state.standstill && distance_ < kArrived) {
        return Status::arrived;
    }
    waited_ += cycle;
    return waited_ > kLongest ? Status::off_target : Status::waiting;
}

void Settling::tellOffTarget(const skill::Execution& execution) const {
    execution.fail(skill::Reason::error,
                   fmt::format("the arm is {:.4f} rad off its set-point {} s after the motion, "
                               "limit {} rad",
                               distance_, kLongest, kArrived));
}

}  // namespace metier::robot_skills
