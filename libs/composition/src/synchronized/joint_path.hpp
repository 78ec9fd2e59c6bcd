#pragma once

#include <string>
#include <vector>

namespace metier::composition {

/// The joint positions that an arm passes on its path [rad], one row per place.
using JointPath = std::vector<std::vector<double>>;

/// An arm that begins again may stand this far off its path [rad].
inline constexpr double kOffPath = 2e-3;

/// How long an arm needs to come from its largest speed on the path to rest at the end of it [s].
/// \param duration of the path, from rest to rest, whose places it passes at equal intervals [s]
double brakingTime(const JointPath& path, double duration);

/// How the joint position `now` is off the straight lines between the places of `path`: "axis 3 by
/// 0.0120 rad, limit 0.002 rad", or "" if it is not.
std::string offPath(const JointPath& path, const std::vector<double>& now);

}  // namespace metier::composition
