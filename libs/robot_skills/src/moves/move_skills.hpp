#pragma once

#include <memory>
#include <vector>

#include "metier/base/clock.hpp"
#include "metier/robot_skills/arm_skills.hpp"

namespace metier::robot_skills {

/// An arm that is moved; all must outlive its skills.
struct MovedArm : ArmDevices {
    const motion::RobotModel& model;  ///< with as many axes as the arm
    const Clock& clock;
    /// Receives the stopping times of its moves; shared with those who publish them.
    std::shared_ptr<StoppingReport> stopping = std::make_shared<StoppingReport>();
};

/// The moves of an arm, in the order of ArmSkills::moves. All need one common Resource.
///
/// Each plans the whole motion at Start, from the commanded joint position, and refuses a motion
/// that cannot be run to its end. Then it decides who runs it: the controller's own planner if its
/// motion is the one asked for, else the arm's cycle thread takes the set-points from metier's
/// plan. metier runs every path, a move with Duration, StartTime or a MaxAcceleration below the
/// robot's own, a line that only turns, a line on which the elbow turns or the tool frame would
/// leave it, and a motion of less than 0.002 rad/s (controller_planned_motion.hpp). The controller
/// may not be faster than the plan; a move to joints must end at them, else it fails.
///
/// With StartTime the arm is made ready at once, holds its position, and begins to move in the
/// cycle after that time. If it is not ready then, the move fails once it is over 0.1 s late.
///
/// Suspend and Halt brake on the path and are answered at the arm's standstill. Resume goes on
/// along the same path, or with the controller's planner to the same target; it is refused if an
/// axis was moved by over 2 mrad meanwhile. Safety stops of the arm end in Halted: limit_violated
/// if a set-point broke a limit of the controller, device_lost if the arm is lost, error for every
/// other one.
///
/// Planning a path takes some milliseconds of the server's thread, up to 0.1 s for a hundred poses.
std::vector<std::unique_ptr<skill::Skill>> makeMoveSkills(const MovedArm& arm);

}  // namespace metier::robot_skills
