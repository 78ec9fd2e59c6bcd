#pragma once

#include <numbers>

#include "metier/edo_driver/messages.hpp"

namespace metier::edo_driver {

// The wire has degrees, and millimetres for the gripper.

inline constexpr double kRadiansPerDegree = std::numbers::pi / 180.0;
inline constexpr double kMetresPerMillimetre = 1e-3;

/// Size of one unit of the wire in SI, for that joint.
inline double unitOf(const JointLayout& layout, std::size_t joint) noexcept {
    return layout.isGripper(joint) ? kMetresPerMillimetre : kRadiansPerDegree;
}

}  // namespace metier::edo_driver
