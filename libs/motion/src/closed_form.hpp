#pragma once

#include "metier/motion/kinematics.hpp"

namespace metier::motion {

/// Finds the closed form that fits the chain; moves `zero.point` to the points where axes meet.
IkKind recogniseStructure(std::size_t axis_count, ZeroPosition& zero);

/// Brings six axes that have nearly the structure of three_parallel_axes, as those of a calibrated
/// arm have, into exactly that: directions within 0.02 rad, points within 10 mm.
/// \return false, and `zero` unchanged, if they are farther off
bool idealise(ZeroPosition& zero);

/// Query for a closed form.
struct ClosedFormQuery {
    Transform base_from_flange;
    JointVector reference;        ///< values of axes that the pose leaves free [rad]
    double redundancy_angle = 0;  ///< arm angle, for an arm_angle chain [rad]
};

/// Joint positions and which of them rounding may have touched.
struct ClosedFormSolutions {
    JointSolutions solutions;
    std::array<bool, JointSolutions::kCapacity> delicate{};
    std::optional<ReachMiss> miss = {};  ///< the least one of the branches that do not reach
};

ClosedFormSolutions solveThreeParallelAxes(const ZeroPosition& zero, const ClosedFormQuery& query);
ClosedFormSolutions solveSphericalWrist(const ZeroPosition& zero, const ClosedFormQuery& query);
ClosedFormSolutions solveArmAngle(const ZeroPosition& zero, const ClosedFormQuery& query);

/// Orthonormal directions across the line from shoulder to wrist: `up` has arm angle 0.
struct ArmPlane {
    Eigen::Vector3d along;
    Eigen::Vector3d up;
    Eigen::Vector3d side;
};
ArmPlane armPlane(const Eigen::Vector3d& shoulder_to_wrist);

}  // namespace metier::motion
