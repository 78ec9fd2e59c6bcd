#pragma once

#include "metier/device/motion_planner.hpp"
#include "metier/motion/robot_model.hpp"
#include "metier/motion/trajectory.hpp"
#include "metier/robot_skills/move_parameters.hpp"
#include "moves/move_variant.hpp"
#include "moves/path_deviation.hpp"

namespace metier::robot_skills {

/// A move as a client asked for it and as metier has planned it.
struct ControllerPlannedRequest {
    const motion::RobotModel& model;
    const motion::Trajectory& trajectory;
    PathDeviationMeter::Path path;
    const MoveParameters& parameters;
};

/// Largest planned speed of the path parameter [1/s].
double plannedPathSpeed(const motion::Trajectory& trajectory) noexcept;

/// Makes the request to a controller's own planner for exactly this move, no faster than planned.
///
/// A PTP becomes a motion to the joints at its end, so that the controller chooses no other
/// configuration. A line becomes a line of the flange. Accelerations are the robot's own, so that
/// the controller can stop as soon as the robot can.
/// Errors: not_supported with the reason, where the controller's motion would differ: for a
/// Duration, a StartTime, a StopTime, a lower MaxAcceleration, a line that only turns, a line on
/// which the tool frame would leave it or the elbow turns, and a motion too slow to be
/// distinguished from standstill.
Result<device::ControllerPlannedMotion> controllerPlannedMotion(
    const ControllerPlannedRequest& request);

}  // namespace metier::robot_skills
