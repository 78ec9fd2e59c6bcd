#pragma once

#include <array>

#include "metier/motion/pose.hpp"
#include "metier/motion/twist.hpp"
#include "metier/robot_skills/move_parameters.hpp"
#include "metier/skill/execution_handle.hpp"

namespace metier::robot_skills {

/// Forces that a force move measured, in the base frame.
struct MetForce {
    motion::Wrench contact;                             ///< at the end
    Eigen::Vector3d largest = Eigen::Vector3d::Zero();  ///< along each axis, without sign [N]
    bool exceeded = false;                              ///< ended the motion
};

/// Tells the end of a force move: finished, or failed if a force over its limit is an error.
void tellForceMove(const skill::ExecutionHandle& tell, const ForceMoveParameters& parameters,
                   const MoveResults& results, const MetForce& met);

}  // namespace metier::robot_skills
