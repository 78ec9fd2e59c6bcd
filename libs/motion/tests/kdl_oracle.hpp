#pragma once

#include <kdl/chain.hpp>
#include <kdl/chainfksolverpos_recursive.hpp>
#include <kdl/chainjnttojacsolver.hpp>

#include "metier/motion/robot_model.hpp"

namespace metier::motion {

/// KDL's view of the same chain: the second opinion. One per thread: KDL 1.5.1 caches inside.
class KdlOracle {
public:
    explicit KdlOracle(const ChainDescription& description);

    motion::Pose forward(const JointVector& q);
    Jacobian jacobian(const JointVector& q);
    const KDL::Chain& chain() const { return chain_; }

private:
    static KDL::Chain makeChain(const ChainDescription& description);
    KDL::JntArray joints(const JointVector& q) const;

    KDL::Chain chain_;
    KDL::ChainFkSolverPos_recursive forward_;
    KDL::ChainJntToJacSolver jacobian_;
};

}  // namespace metier::motion
