#pragma once

#include <Eigen/Geometry>

namespace metier::motion {

/// The rotation by |vector| about vector.
/// \param vector [rad], any length, also zero
Eigen::Quaterniond fromRotationVector(const Eigen::Vector3d& vector);

/// The short way of a rotation as axis times angle, angle in [0, pi] [rad].
/// At 180 degrees, where both axes are right, the one whose first non-zero component is positive.
Eigen::Vector3d toRotationVector(const Eigen::Quaterniond& rotation);

/// What turns `from` into `to` the short way, seen from outside: to = fromRotationVector(v) * from.
/// Deterministic at 180 degrees.
Eigen::Vector3d rotationVectorBetween(const Eigen::Quaterniond& from, const Eigen::Quaterniond& to);

/// Angle of the rotation from one to the other, in [0, pi] [rad]; exact for tiny angles too.
double rotationAngleBetween(const Eigen::Quaterniond& first, const Eigen::Quaterniond& second);

/// Constant-speed rotation from `from` (fraction 0) to `to` (fraction 1), always the short way.
Eigen::Quaterniond slerp(const Eigen::Quaterniond& from, const Eigen::Quaterniond& to,
                         double fraction);

}  // namespace metier::motion
