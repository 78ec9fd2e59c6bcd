#pragma once

#include "metier/device/motion_planner.hpp"
#include "metier/motion/robot_model.hpp"
#include "metier/motion/trajectory.hpp"
#include "metier/skill/value.hpp"

namespace metier::robot_skills {

/// Limits along the base frame's axes as limits along the flange's, where these are the same for
/// the whole motion.
/// Errors: not_supported with the angle between them.
Result<device::ForceCondition> flangeCondition(const motion::RobotModel& model,
                                               const motion::Trajectory& trajectory,
                                               const skill::Vector3& max_force);

}  // namespace metier::robot_skills
