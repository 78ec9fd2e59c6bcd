#pragma once

#include "metier/base/quantities.hpp"
#include "metier/motion/pose.hpp"

namespace metier::motion {

using metier::Frame;

/// The pose of a frame; any finite angles.
Pose toPose(const Frame& frame);

/// The frame of a pose: a and c in (-pi, pi], b in [-pi/2, pi/2].
/// Where b is +-pi/2 only a sum of a and c is defined: a is 0 then.
Frame toFrame(const Pose& pose);

}  // namespace metier::motion
