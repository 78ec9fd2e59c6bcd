#include "moves/arm_work.hpp"

#include <fmt/format.h>

#include <cmath>
#include <utility>

namespace metier::robot_skills {

using device::SafetyState;
using skill::Reason;

ArmWork::ArmWork(device::Arm& arm, ToolDistance tool_distance)
    : arm_(arm), tool_distance_(std::move(tool_distance)) {}

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
        fmt::format("the arm was moved while it was suspended: axis {} by {:.4f} rad, limit "
                    "{} rad; the tool frame by {:.4f} m",
                    worst + 1, moved, kMovedTolerance, tool_distance_(position, rest)));
}

}  // namespace metier::robot_skills
