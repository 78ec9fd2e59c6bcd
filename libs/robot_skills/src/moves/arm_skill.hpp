#pragma once

#include "metier/device/arm.hpp"
#include "metier/motion/robot_model.hpp"

namespace metier::robot_skills {

/// Whether the arm could begin to move now.
/// Errors: device_fault with the controller's reason; invalid_state while the arm still moves.
Result<void> checkReady(const device::Arm& arm);

/// Brings the arm back after a fault, so that it could begin to move.
/// Errors: those of Arm::resetFault(); invalid_state while the arm still moves, as it may after a
/// link was lost whose controller goes on by itself.
Result<void> resetArm(device::Arm& arm);

/// Errors: invalid_argument if arm and model differ in their number of axes.
Result<void> checkSameAxes(const device::Arm& arm, const motion::RobotModel& model);

}  // namespace metier::robot_skills
