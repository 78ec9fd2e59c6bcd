#pragma once

#include <memory>

#include "metier/device/arm.hpp"
#include "metier/motion/robot_model.hpp"
#include "metier/skill/skill.hpp"

namespace metier::robot_skills {

/// The four moves of an arm. Each plans the whole motion at Start, from where the arm is commanded
/// to stand, and refuses what cannot be run to its end; then the arm's cycle thread takes the
/// set-points from the plan.
///
/// Suspend and Halt brake on the path and are answered at the arm's standstill. Resume goes on
/// along the same path; it is refused if an axis was moved by over 2 mrad meanwhile. Safety stops
/// of the arm end in Halted: limit_violated if a set-point broke a limit of the controller, error
/// for every other, device_lost if the arm is gone.
///
/// `arm` and `model` must outlive the skills; all skills of one arm need one common Resource.
/// Errors of all: invalid_argument if arm and model differ in their number of axes.
Result<std::unique_ptr<skill::Skill>> makeCartesianPtpMoveSkill(device::Arm& arm,
                                                                const motion::RobotModel& model);
Result<std::unique_ptr<skill::Skill>> makeCartesianLinearMoveSkill(device::Arm& arm,
                                                                   const motion::RobotModel& model);
Result<std::unique_ptr<skill::Skill>> makeJointPtpMoveSkill(device::Arm& arm,
                                                            const motion::RobotModel& model);
Result<std::unique_ptr<skill::Skill>> makeJointLinearMoveSkill(device::Arm& arm,
                                                               const motion::RobotModel& model);

}  // namespace metier::robot_skills
