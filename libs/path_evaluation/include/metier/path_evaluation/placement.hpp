#pragma once

#include "metier/base/error.hpp"
#include "metier/motion/chain.hpp"
#include "metier/motion/joint_vector.hpp"
#include "metier/path_evaluation/square.hpp"

namespace metier::path_evaluation {

/// Finds where an arm has most room for an upright square, from its published chain and limits
/// alone: candidates all over its reach are compared by their distance from joint limits and from
/// singularities.
///
/// \param current where the arm is now [rad]; the square lies on the side it already points to
/// \param side    [m], > 0
/// \return the square for the flange frame
/// Errors:  unreachable if no candidate fits, with the reach; invalid_argument (sizes, side).
/// Threads: any; pure.
Result<Square> placeSquare(const motion::ChainDescription& chain,
                           const motion::JointVector& current, double side);

}  // namespace metier::path_evaluation
