#pragma once

#include "metier/device/arm.hpp"

namespace metier::robot_skills {

/// Whether the arm could begin to move now.
/// Errors: device_fault with the controller's reason; resource_unavailable while the arm still
/// moves.
Result<void> checkReady(const device::Arm& arm);

/// Clears a fault of the arm, so that it could begin to move.
/// Errors: those of Arm::resetFault(); resource_unavailable while the arm still moves, which it may
/// after the link to a controller was lost that goes on by itself.
Result<void> resetArm(device::Arm& arm);

}  // namespace metier::robot_skills
