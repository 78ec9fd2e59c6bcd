#include "moves/arm_skill.hpp"

#include <fmt/format.h>

namespace metier::robot_skills {
namespace {

Result<void> checkStanding(const device::Arm& arm) {
    return arm.state().standstill
               ? Result<void>()
               : fail(Errc::resource_unavailable, arm.info().name + ": the arm still moves");
}

}  // namespace

Result<void> checkReady(const device::Arm& arm) {
    const auto safety = arm.safety();
    if (safety.state != device::SafetyState::normal) {
        return fail(Errc::device_fault,
                    fmt::format("{} ({})", safety.text, device::toString(safety.state)));
    }
    return checkStanding(arm);
}

Result<void> resetArm(device::Arm& arm) {
    return arm.resetFault().and_then([&] { return checkStanding(arm); });
}

Result<void> checkSameAxes(const device::Arm& arm, const motion::RobotModel& model) {
    if (arm.info().axisCount() != model.axisCount()) {
        return fail(Errc::invalid_argument,
                    fmt::format("{} has {} axes, the model {} has {}", arm.info().name,
                                arm.info().axisCount(), model.name(), model.axisCount()));
    }
    return {};
}

}  // namespace metier::robot_skills
