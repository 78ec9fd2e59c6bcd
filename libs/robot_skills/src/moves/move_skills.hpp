#pragma once

#include <memory>

#include "metier/base/clock.hpp"
#include "metier/device/arm.hpp"
#include "metier/motion/robot_model.hpp"
#include "metier/robot_skills/stopping_report.hpp"
#include "metier/skill/skill.hpp"

namespace metier::robot_skills {

/// An arm that takes the set-points of metier's planner; all must outlive its skills.
struct StreamedArm {
    device::Arm& arm;
    const motion::RobotModel& model;
    const Clock& clock;
    /// Receives the stopping times of its moves; shared with those who publish them.
    std::shared_ptr<StoppingReport> stopping = std::make_shared<StoppingReport>();
};

/// The moves of an arm. Each plans the whole motion at Start, from the commanded joint position,
/// and refuses a motion that cannot be run to its end; then the arm's cycle thread takes the
/// set-points from the plan.
///
/// With StartTime the arm is made ready at once, holds its position, and begins to move in the
/// cycle after that time. If it is not ready then, the move fails once it is over 0.1 s late.
///
/// Suspend and Halt brake on the path and are answered at the arm's standstill. Resume goes on
/// along the same path; it is refused if an axis was moved by over 2 mrad meanwhile. Safety stops
/// of the arm end in Halted: limit_violated if a set-point broke a limit of the controller,
/// device_lost if the arm is lost, error for every other one.
///
/// All skills of one arm need one common Resource.
/// Errors of all: invalid_argument if arm and model differ in their number of axes.
Result<std::unique_ptr<skill::Skill>> makeCartesianPtpMoveSkill(const StreamedArm& arm);
Result<std::unique_ptr<skill::Skill>> makeCartesianLinearMoveSkill(const StreamedArm& arm);
Result<std::unique_ptr<skill::Skill>> makeJointPtpMoveSkill(const StreamedArm& arm);
Result<std::unique_ptr<skill::Skill>> makeJointLinearMoveSkill(const StreamedArm& arm);
/// Planning takes some milliseconds of the server's thread, up to 0.1 s for a hundred poses.
Result<std::unique_ptr<skill::Skill>> makeCartesianPathMoveSkill(const StreamedArm& arm);

}  // namespace metier::robot_skills
