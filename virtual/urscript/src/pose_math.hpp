#pragma once

#include "metier/urscript/value.hpp"

namespace metier::urscript {

// Pose functions of a script. Pure; any finite poses.
// Source: script manual, module urmath.

/// base_from_target = base_from_source * source_from_target.
Pose transformed(const Pose& base_from_source, const Pose& source_from_target);
Pose inverted(const Pose& pose);
/// Positions are added, rotations multiplied: left times right.
Pose added(const Pose& left, const Pose& right);
/// Positions are subtracted; the rotation leads from `from` to `to`, in the base frame.
Pose subtracted(const Pose& to, const Pose& from);
/// Pose on the straight line and the shortest rotation; alpha 0 is `from`, 1 is `to`, any value is
/// allowed.
Pose interpolated(const Pose& from, const Pose& to, double alpha);

/// Roll, pitch and yaw [rad] of a rotation vector: Rz(yaw) Ry(pitch) Rx(roll).
Vector3 rollPitchYawOf(const Vector3& rotation_vector);
Vector3 rotationVectorOf(const Vector3& roll_pitch_yaw);

}  // namespace metier::urscript
