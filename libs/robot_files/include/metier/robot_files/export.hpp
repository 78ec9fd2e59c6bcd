#pragma once

#include <string>
#include <vector>

#include "metier/motion/robot_model.hpp"

namespace metier::robot_files {

/// A robot model as URDF and SRDF files.
struct ExportedRobot {
    std::string urdf;
    /// Home position and the pairs of links that are not compared.
    std::string srdf;
    /// What the files do not hold, one sentence each.
    std::vector<std::string> left_out;
};

/// Writes a robot model as URDF and SRDF: link "base_link", a link for each axis, "tool0" for the
/// flange, a link for each tool frame. importUrdf() reads the same kinematics, limits, tool frames
/// and capsules. Threads: any; pure.
ExportedRobot exportUrdf(const motion::RobotModel& model);

}  // namespace metier::robot_files
