#pragma once

#include "metier/device/motion_planner.hpp"
#include "metier/motion/pose.hpp"
#include "metier/motion/robot_model.hpp"

namespace metier::iiwa_driver {

/// Checks whether the cabinet would accept this motion, since it does not report what it refuses.
/// Errors: invalid_argument (sizes, not finite, a share outside (0, 1]), out_of_range (axis and
/// limit), unreachable.
Result<void> checkMotion(const motion::RobotModel& model,
                         const device::ControllerPlannedMotion& motion);

/// Checks that the cabinet and the model agree on the pose of the flange. Errors: device_fault with
/// the distance of both poses.
Result<void> checkSameFlange(const motion::Pose& by_model, const motion::Pose& by_cabinet);

}  // namespace metier::iiwa_driver
