#include "moves/arm_skill.hpp"

namespace metier::robot_skills {
namespace {

Result<void> checkStanding(const device::Arm& arm) {
    return arm.state().standstill
               ? Result<void>()
               : fail(Errc::resource_unavailable, arm.info().name + ": the arm still moves");
}

}  // namespace

Result<void> checkReady(const device::Arm& arm) {
    METIER_TRY(device::checkNormal(arm.safety()));
    return checkStanding(arm);
}

Result<void> resetArm(device::Arm& arm) {
    METIER_TRY(arm.resetFault());
    return checkStanding(arm);
}

}  // namespace metier::robot_skills
