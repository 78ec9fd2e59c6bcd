#pragma once

#include "metier/motion/robot_model.hpp"

namespace metier::robot_files {

/// A working position far from singularities: of many inside the middle of the ranges the one with
/// the largest smallest singular value of the Jacobian, with no joint frame and no flange below the
/// base's origin if there is such a position. The same chain gives the same position.
motion::JointVector searchHome(const motion::RobotModel& model);

}  // namespace metier::robot_files
