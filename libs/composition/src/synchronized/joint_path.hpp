#pragma once

#include <string>
#include <vector>

namespace metier::composition {

/// The joint positions that an arm passes on its path [rad], one row per place.
using JointPath = std::vector<std::vector<double>>;

/// An arm that begins again may stand this far off its path [rad].
inline constexpr double kOffPath = 2e-3;

/// Time that an arm needs to brake from its largest speed on the path to rest at the path's end
/// [s].
/// \param duration of the path from rest to rest [s]; its places are passed at equal intervals
double brakingTime(const JointPath& path, double duration);

/// Describes how far the joint position `now` is from the straight lines between the places of
/// `path`: "axis 3 by 0.0120 rad, limit 0.002 rad"; "" if it is on them.
std::string offPath(const JointPath& path, const std::vector<double>& now);

}  // namespace metier::composition
