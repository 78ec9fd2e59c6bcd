#pragma once

#include <Eigen/Geometry>

namespace metier::motion {

/// Rotation about `vector` by the angle |vector|, right-handed. Threads of all functions here: any;
/// pure.
/// \param vector [rad], any length, also zero
Eigen::Quaterniond fromRotationVector(const Eigen::Vector3d& vector);

/// Rotation vector (axis times angle) of the short way of a rotation, angle in [0, pi] [rad]. At
/// 180 degrees two axes are right: the one whose first non-zero component is positive is taken.
/// \param rotation unit quaternion, as are all quaternions here
Eigen::Vector3d toRotationVector(const Eigen::Quaterniond& rotation);

/// Rotation vector v [rad] that turns `from` into `to` the short way, in the axes of the frame in
/// which both are given: to = fromRotationVector(v) * from. Deterministic at 180 degrees.
Eigen::Vector3d rotationVectorBetween(const Eigen::Quaterniond& from, const Eigen::Quaterniond& to);

/// Angle of the rotation from one to the other, in [0, pi] [rad]; exact for tiny angles too.
double rotationAngleBetween(const Eigen::Quaterniond& first, const Eigen::Quaterniond& second);

/// Constant-speed rotation from `from` (fraction 0) to `to` (fraction 1), always the short way; a
/// fraction outside goes on beyond them.
Eigen::Quaterniond slerp(const Eigen::Quaterniond& from, const Eigen::Quaterniond& to,
                         double fraction);

}  // namespace metier::motion
