#pragma once

#include <Eigen/Geometry>

namespace metier::motion {

/// A rigid transform, named target_from_source: maps coordinates of the source frame into the
/// target frame. Neighbours match: base_from_tool = base_from_flange * flange_from_tool.
///
///     const Pose base_from_part = base_from_tool * tool_from_part;
///     const Eigen::Vector3d in_base = base_from_part * point_in_part;
struct Pose {
    /// Origin of the source frame in the target frame [m].
    Eigen::Vector3d translation = Eigen::Vector3d::Zero();
    /// Rotation of the source frame in the target frame; must be a unit quaternion.
    Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();

    /// The transform between two equal frames.
    static Pose identity() { return {}; }
    /// The transform back: source_from_target.
    Pose inverse() const;
};

/// Chains two transforms: a_from_c = a_from_b * b_from_c. The rotation is normalised.
Pose operator*(const Pose& a_from_b, const Pose& b_from_c);

/// Converts a point from source coordinates to target coordinates [m].
Eigen::Vector3d operator*(const Pose& target_from_source, const Eigen::Vector3d& point);

/// Distance of the two origins [m].
/// Rotations do not count. Threads: any; pure, as all functions here.
double distanceBetween(const Pose& first, const Pose& second);

}  // namespace metier::motion
