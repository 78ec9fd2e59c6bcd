#pragma once

#include <kdl/chain.hpp>
#include <kdl/chainfksolverpos_recursive.hpp>

#include <string>

#include "metier/motion/joint_vector.hpp"
#include "metier/motion/pose.hpp"

namespace metier::robot_files {

/// KDL's view of a chain in a URDF file, read without a line of the importer: the second opinion.
/// One per thread: KDL 1.5.1 caches inside.
class KdlUrdf {
public:
    /// Throws if the file has no such chain.
    KdlUrdf(const std::string& urdf, const std::string& base, const std::string& tip);

    std::size_t axisCount() const { return chain_.getNrOfJoints(); }
    /// base_from_tip
    motion::Pose forward(const motion::JointVector& q);

private:
    static KDL::Chain read(const std::string& urdf, const std::string& base,
                           const std::string& tip);

    KDL::Chain chain_;
    KDL::ChainFkSolverPos_recursive forward_;
};

}  // namespace metier::robot_files
