#pragma once

#include "metier/geometry/pose.hpp"

namespace metier::geometry {

/// A pose as OPC UA's 3DFrame carries it: position [m] and rotations a, b, c about x, y, z [rad]
/// with R = Rz(c) * Ry(b) * Rx(a).
struct Frame {
    double x = 0;
    double y = 0;
    double z = 0;
    double a = 0;
    double b = 0;
    double c = 0;
};

/// The pose of a frame; any finite angles.
Pose toPose(const Frame& frame);

/// The frame of a pose: a and c in (-pi, pi], b in [-pi/2, pi/2].
/// Where b is +-pi/2 only a sum of a and c is defined: a is 0 then.
Frame toFrame(const Pose& pose);

}  // namespace metier::geometry
