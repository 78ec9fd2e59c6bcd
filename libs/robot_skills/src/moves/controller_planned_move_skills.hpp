#pragma once

#include <memory>
#include <vector>

#include "metier/base/clock.hpp"
#include "metier/device/arm.hpp"
#include "metier/device/force_torque_sensor.hpp"
#include "metier/device/motion_planner.hpp"
#include "metier/motion/robot_model.hpp"
#include "metier/robot_skills/stopping_report.hpp"
#include "metier/skill/skill.hpp"

namespace metier::robot_skills {

/// An arm whose controller has a planner of its own and takes set-points, too; all must outlive the
/// skills.
struct PlanningArm {
    device::Arm& arm;
    device::MotionPlanner& planner;
    const motion::RobotModel& model;
    const Clock& clock;
    /// Watches the force of force moves that are streamed; nullptr: such moves are refused.
    device::ForceTorqueSensor* sensor = nullptr;
    /// Receives the stopping times of its moves; shared with those who publish them.
    std::shared_ptr<StoppingReport> stopping = std::make_shared<StoppingReport>();
};

/// The four moves of makeCartesianPtpMoveSkill() and its neighbours: the same names, parameters,
/// checks and results.
///
/// metier plans each motion. At Start it decides who runs it: the controller's own planner if its
/// motion is the one asked for, else metier with set-points. metier runs a move with Duration,
/// StartTime or a MaxAcceleration below the robot's own, a line that only turns, a line on which
/// the elbow turns or the tool frame would leave it, and a motion of less than 0.002 rad/s
/// (controller_planned_motion.hpp). The controller may not be faster than the plan; a move to
/// joints must end at them, else it fails.
///
/// Suspend and Halt brake and are answered at standstill, with either planner. Resume goes on to
/// the same target, from the present position; it is refused if an axis was moved by over 2 mrad.
/// Errors: invalid_argument if arm and model differ in their number of axes.
Result<std::vector<std::unique_ptr<skill::Skill>>> makeControllerPlannedMoveSkills(
    const PlanningArm& arm);

}  // namespace metier::robot_skills
