#pragma once

#include <memory>
#include <vector>

#include "metier/base/clock.hpp"
#include "metier/device/arm.hpp"
#include "metier/device/motion_planner.hpp"
#include "metier/motion/robot_model.hpp"
#include "metier/skill/skill.hpp"

namespace metier::robot_skills {

/// Whoever moves by its controller's own planner; all must outlive the skills.
struct PlanningArm {
    device::Arm& arm;
    device::MotionPlanner& planner;
    const motion::RobotModel& model;
    const Clock& clock;
};

/// The four moves of makeCartesianPtpMoveSkill() and its like, run by the controller's own planner:
/// the same names, parameters, checks and results.
///
/// metier plans each motion, too: what its planner refuses is refused, and the controller may not
/// be faster than the plan. Refused besides, with not_supported: a line of a tool frame that turns
/// about anything but the flange, and a line on which the elbow turns. A move to joints must end at
/// them, else it fails. A Duration is the least that the motion takes; a StartTime is refused with
/// not_supported.
///
/// Suspend and Halt stop the motion as the controller does, and are answered at standstill. Resume
/// asks for the same target again, from where the arm stands; it is refused as that of the other
/// moves is.
/// Errors: invalid_argument if arm and model differ in their number of axes.
Result<std::vector<std::unique_ptr<skill::Skill>>> makePlannedMoveSkills(const PlanningArm& arm);

}  // namespace metier::robot_skills
