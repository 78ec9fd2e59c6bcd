#pragma once

#include <limits>
#include <numbers>

namespace metier {

/// Value for "no limit".
/// JSON has no number for it: jsonOf() in libs/skill writes null.
inline constexpr double kInfinity = std::numeric_limits<double>::infinity();
/// One millimetre [m]: `20 * kMillimetre` is a length in metres.
inline constexpr double kMillimetre = 1e-3;
/// Factor from [m] to [mm], for texts and for wires that use millimetres.
inline constexpr double kMillimetresPerMetre = 1000.0;
/// One degree [rad]: `90 * kDegree` is an angle in radians.
inline constexpr double kDegree = std::numbers::pi / 180.0;

}  // namespace metier
