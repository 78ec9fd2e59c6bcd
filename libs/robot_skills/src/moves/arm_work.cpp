#include "moves/arm_work.hpp"

#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "conversions.hpp"

namespace metier::robot_skills {

using device::SafetyState;
using skill::Reason;

ToolPose toolPoseOf(const motion::Trajectory& trajectory) {
    return [trajectory](const motion::JointVector& joints) { return trajectory.toolPose(joints); };
}

ArmWork::ArmWork(device::Arm& arm, ToolPose tool_pose)
    : arm_(arm), tool_pose_(std::move(tool_pose)) {}

void ArmWork::begin(skill::ExecutionHandle execution, std::function<bool()> in_motion) {
    execution_ = std::move(execution);
    safety_watch_ = arm_.onSafetyChange(
        [in_motion = std::move(in_motion), tell = execution_](const device::Safety& safety) {
            if (safety.state == SafetyState::normal || in_motion()) {
                return;
            }
            const bool lost = safety.state == SafetyState::disconnected;
            tell.fail(lost ? Reason::device_lost : Reason::error, safety.text);
        });
}

Result<void> ArmWork::checkNotMoved(const device::JointArray& rest) const {
    const auto position = arm_.state().position;
    std::size_t worst = 0;
    for (std::size_t axis = 0; axis < rest.size(); ++axis) {
        if (std::abs(position[axis] - rest[axis]) > std::abs(position[worst] - rest[worst])) {
            worst = axis;
        }
    }
    const double moved = std::abs(position[worst] - rest[worst]);
    if (moved <= kMovedTolerance) {
        return {};
    }
    return fail(
        Errc::out_of_range,
        fmt::format(
            "the arm was moved while it was suspended: axis {} by {:.4f} rad, limit "
            "{} rad; the tool frame by {:.4f} m",
            worst + 1, moved, kMovedTolerance,
            motion::distanceBetween(tool_pose_(toVector(position)), tool_pose_(toVector(rest)))));
}

}  // namespace metier::robot_skills
