#pragma once

#include <optional>

#include "metier/device/arm.hpp"
#include "metier/device/motion_planner.hpp"
#include "metier/motion/robot_model.hpp"
#include "metier/motion/trajectory.hpp"
#include "path_deviation.hpp"

namespace metier::robot_skills {

/// A controller's planner begins when it is asked to.
/// Errors: not_supported if there is a start time.
Result<void> checkNoStartTime(const device::Arm& arm, const std::optional<double>& start_time);

/// What the controller's own planner is asked for so that the arm does what metier has planned, no
/// faster.
///
/// A PTP becomes a motion to the joints at its end, so that the controller chooses no other
/// configuration. A line becomes a line of the flange.
/// Errors: not_supported if the flange's line is not the tool frame's, or if the arm would have to
/// turn its elbow on the way, which a controller's line does not.
Result<device::PlannedMotion> plannedMotion(const motion::RobotModel& model,
                                            const motion::Trajectory& trajectory,
                                            PathDeviationMeter::Path path);

}  // namespace metier::robot_skills
