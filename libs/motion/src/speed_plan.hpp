#pragma once

#include <array>
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

/// Three joint positions in a row, `step` [s] apart.
struct JointSteps {
    std::array<JointVector, 3> positions;
    double step = 0;
};

/// Check of the tool frame where its path is not the one that the bounds are of.
struct ToolCheck {
    /// Whether it is needed from that knot to the next one.
    std::function<bool(std::size_t knot)> applies;
    /// Factor by which a motion after that knot has to be slower; up to 1 if it is slow enough.
    std::function<double(std::size_t knot, const JointSteps& steps)> factor;
};

/// The path that the bounds were taken from, at any place.
struct ExactPath {
    std::function<JointVector(double place)> position;
    ToolCheck tool;
};

/// The quickest run from rest to rest that keeps every bound.
/// \param places path parameters of the knots; \param bounds there
SpeedPlan planSpeed(const std::vector<double>& places, const std::vector<SpeedBounds>& bounds,
                    const ExactPath& exact);

}  // namespace metier::motion
