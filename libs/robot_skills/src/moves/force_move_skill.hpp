#pragma once

#include <memory>

#include "moves/move_skills.hpp"

namespace metier::robot_skills {

/// CartesianLinearForceMoveSkill: a CartesianLinearMoveSkill that ends at its target or where a
/// contact force along an axis of the base frame exceeds MaxForce. Either end is a result, with the
/// contact's force; with HaltOnForce a force over its limit is an error: Halted, force_exceeded. A
/// force that is over its limit at the start ends the motion before it begins.
///
/// By the controller's own planner and force condition where these do what was asked: the
/// controller stops the arm by itself, within its own cycle. A controller watches the axes of the
/// flange: each axis of the base frame that has a limit must be one of the flange's, within 1
/// degree, for the whole motion. ForcesMax is then measured along the flange's axes, too. What else
/// it cannot do: makeMoveSkills().
///
/// Else by set-points and the sensor, whose axes are those of the flange frame: the force passes a
/// low-pass of 20 Hz (motion::ForceLimit) and is watched in each cycle of the arm; over a limit the
/// arm brakes on its path, with twice the acceleration of the motion. A sensor that fails meanwhile
/// stops it likewise: Halted, error. Without a sensor Start refuses with not_supported what the
/// controller cannot do.
/// \param arm has a planner or a sensor
std::unique_ptr<skill::Skill> makeForceMoveSkill(const MovedArm& arm);

}  // namespace metier::robot_skills
