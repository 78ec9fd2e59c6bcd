#pragma once

#include <string>
#include <vector>

#include "commands.hpp"
#include "metier/motion/planner.hpp"

namespace metier::app {

/// A move as the command line describes it.
struct MoveOptions {
    std::string robot;
    std::string from;
    std::vector<std::string> to_poses;
    std::string to_joints;
    bool linear = false;
    std::string relative = "no";
    std::string tool;
    std::string max_velocity;
    std::string max_acceleration;
    std::string axis_bounds;
    double speed_override = 1.0;
    std::string arm_angle;
    double blend_radius = 0.0;  ///< [m]
};

/// A move, and what its skill's Start would answer.
struct PlannedMove {
    std::string skill;          ///< its name
    motion::JointVector start;  ///< [rad]
    motion::Planned<motion::Trajectory> plan;
};

/// Adds the options of a move to a command, but for the robot.
void addMoveOptions(CLI::App& command, MoveOptions& options);

/// Whether a target is given.
bool hasTarget(const MoveOptions& options) noexcept;

/// Checks the parameters and plans as the skill's server does; a value that the server would refuse
/// is a Refusal, too.
/// Errors: invalid_argument if an option cannot be read.
Result<PlannedMove> planMove(const motion::RobotModel& model, const MoveOptions& options);

}  // namespace metier::app
