#pragma once

#include "metier/device/motion_planner.hpp"
#include "metier/motion/pose.hpp"
#include "metier/motion/robot_model.hpp"

namespace metier::iiwa_driver {

/// Whether the cabinet may be asked for this motion: it does not say what it does not accept.
/// Errors: invalid_argument (sizes, not finite, a share outside (0, 1]), out_of_range (axis and
/// limit), unreachable.
Result<void> checkMotion(const motion::RobotModel& model,
                         const device::ControllerPlannedMotion& motion);

/// Whether the cabinet sees the flange where the model does. Errors: device_fault with both poses'
/// distance.
Result<void> checkSameFlange(const motion::Pose& by_model, const motion::Pose& by_cabinet);

}  // namespace metier::iiwa_driver
