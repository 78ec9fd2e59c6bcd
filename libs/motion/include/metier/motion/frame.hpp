#pragma once

#include "metier/base/quantities.hpp"
#include "metier/motion/pose.hpp"

namespace metier::motion {

/// Converts a 3DFrame to a pose: R = Rz(c) * Ry(b) * Rx(a). The angles may have any finite value;
/// the frames stay those of the name: base_from_tool. Threads: any; pure.
Pose toPose(const Frame& frame);

/// Converts a pose to a 3DFrame: a and c in [-pi, pi], b in [-pi/2, pi/2]. If b is +-pi/2, only a
/// sum or difference of a and c is defined: a is 0 then. Threads: any; pure.
Frame toFrame(const Pose& pose);

}  // namespace metier::motion
