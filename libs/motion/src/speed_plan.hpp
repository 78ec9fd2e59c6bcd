#pragma once

#include <functional>
#include <vector>

#include "limits_along.hpp"
#include "metier/motion/profile.hpp"
#include "speed_bounds.hpp"
#include "speed_map.hpp"

namespace metier::motion {

/// Planned speed along a path.
struct SpeedPlan {
    SpeedMap map;
    LimitsAlong clock;    ///< limits for changes of the clock's speed
    double velocity = 1;  ///< speed of the clock
    Profile profile;      ///< the clock's run

    /// The same slowed down by `factor` >= 1.
    SpeedPlan slowed(double factor) const;
};

/// A path of constant derivatives. \param limits of the path parameter [1/s], [1/s2], [1/s3]
SpeedPlan evenSpeed(const ScalarLimits& limits);

/// Exact joint position at a path parameter.
using PositionAt = std::function<JointVector(double)>;

/// The quickest run from rest to rest that keeps every bound.
/// \param places path parameters of the knots; \param bounds there
SpeedPlan planSpeed(const std::vector<double>& places, const std::vector<SpeedBounds>& bounds,
                    const PositionAt& position);

}  // namespace metier::motion
