#pragma once

#include <cstddef>
#include <vector>

#include "speed_bounds.hpp"

namespace metier::motion {

/// A stretch of a path whose speed is to be found.
struct Course {
    const std::vector<double>& places;       ///< path parameters of the knots
    const std::vector<SpeedBounds>& bounds;  ///< bounds at the knots
    /// Most that the square of the path parameter's speed may be at each knot, > 0.
    std::vector<double> ceiling;
    std::size_t first = 0;  ///< knot before which the speed stays the same
    std::size_t last = 0;   ///< knot after which it does; at least three after the first
};

/// Speed of the path parameter at a knot.
struct CourseSpeed {
    double square = 0;
    double slope = 0;  ///< slope of half the square, by the path parameter
};

/// The speeds at all knots with which the path takes the least time, while every bound keeps
/// `share` of its acceleration and its jerk. Between knots the square is a polynomial of second
/// degree.
///
/// Source: docs/motion.md#speed-along-a-path.
std::vector<CourseSpeed> fastestCourse(const Course& course, double share);

}  // namespace metier::motion
