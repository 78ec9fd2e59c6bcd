#pragma once

#include "metier/base/quantities.hpp"
#include "metier/motion/pose.hpp"

namespace metier::motion {

/// Converts a 3DFrame to a pose; the angles may have any finite value.
Pose toPose(const Frame& frame);

/// Converts a pose to a 3DFrame: a and c in (-pi, pi], b in [-pi/2, pi/2]. If b is +-pi/2, only a
/// sum or difference of a and c is defined: a is 0 then.
Frame toFrame(const Pose& pose);

}  // namespace metier::motion
