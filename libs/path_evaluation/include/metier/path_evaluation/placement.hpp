#pragma once

#include "metier/base/error.hpp"
#include "metier/motion/chain.hpp"
#include "metier/motion/joint_vector.hpp"
#include "metier/path_evaluation/square.hpp"

namespace metier::path_evaluation {

/// Finds the place where an arm has most room for an upright square, from its published chain and
/// limits alone: candidates all over its reach are compared by their distance from joint limits and
/// from singularities.
///
/// \param current present joint position [rad]; the square lies on the side to which the arm points
/// \param side    length of a side [m], > 0
/// \return the square for the flange frame
/// Errors:  unreachable if no candidate fits, with the reach; invalid_argument (sizes, side).
/// Threads: any; pure.
Result<Square> placeSquare(const motion::ChainDescription& chain,
                           const motion::JointVector& current, double side);

}  // namespace metier::path_evaluation
