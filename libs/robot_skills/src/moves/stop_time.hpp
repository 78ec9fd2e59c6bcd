#pragma once

#include <optional>

#include "metier/motion/robot_model.hpp"
#include "metier/motion/trajectory.hpp"

namespace metier::robot_skills {

/// Braking time of a Suspend of this motion [s], by motion::PaceBrake, at any time of the motion.
///
/// At least `asked`; longer where an axis would need more than 1.2 times the robot's own
/// acceleration, or twice its jerk, for it.
/// \param asked [s]
/// \return 0 if `asked` is none or 0, or if over 4 s are needed: then it stops by its own limits
double stopTimeFor(const motion::Trajectory& trajectory, const motion::RobotModel& model,
                   const std::optional<double>& asked);

}  // namespace metier::robot_skills
