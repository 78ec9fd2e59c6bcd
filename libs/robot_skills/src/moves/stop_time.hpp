#pragma once

#include <optional>

#include "metier/motion/robot_model.hpp"
#include "metier/motion/trajectory.hpp"

namespace metier::robot_skills {

/// How long a Suspend of a motion brakes, as motion::PaceBrake does, at whatever time it comes [s].
///
/// At least `asked`; longer where an axis would need more than 1.2 times the robot's own
/// acceleration, or twice its jerk, for it.
/// \param asked [s]
/// \return 0 if none or 0 is asked for, or over 4 s are needed: it stops by its own limits
double stopTimeFor(const motion::Trajectory& trajectory, const motion::RobotModel& model,
                   const std::optional<double>& asked);

}  // namespace metier::robot_skills
