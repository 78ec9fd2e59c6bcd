#pragma once

#include <limits>
#include <numbers>

namespace metier {

inline constexpr double kInfinity = std::numeric_limits<double>::infinity();
inline constexpr double kMillimetre = 1e-3;  ///< [m]
inline constexpr double kMillimetresPerMetre = 1000.0;
inline constexpr double kDegree = std::numbers::pi / 180.0;  ///< [rad]

}  // namespace metier
