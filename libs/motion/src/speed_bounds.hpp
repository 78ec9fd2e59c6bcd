#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "metier/motion/robot_model.hpp"
#include "path.hpp"

namespace metier::motion {

/// Bounds of the speed at one place of a path: the derivatives by the path parameter of an axis,
/// or of the tool frame, and the limits of the same by time.
struct SpeedBound {
    double first = 0;
    double second = 0;
    double third = 0;
    double velocity = 0;
    double acceleration = 0;
    double jerk = 0;
    /// Lengths of vectors, not numbers with a sign: they may add up or not.
    bool lengths = false;
};

/// A bound between two knots, where the path bends as at the worse of them or less. Where a
/// velocity limit changes, the knot has the lower one, and the higher one holds beside it.
SpeedBound between(const SpeedBound& a, const SpeedBound& b) noexcept;

/// All bounds at one place; the first ones are the axes'.
struct SpeedBounds {
    std::array<SpeedBound, kMaxAxes + 2> values;
    std::size_t count = 0;

    void add(const SpeedBound& bound) noexcept { values[count++] = bound; }
};

/// Bounds of the axes at the knots of a path.
std::vector<SpeedBounds> axisBounds(const RobotModel& model, const JointPath& path);

/// The axis that holds the path back most.
struct SpeedBottleneck {
    double share = 1;  ///< share of the requested speed that the slowest place allows
    std::size_t axis = 0;
    std::size_t knot = 0;
};
/// \param speed requested, of the path parameter [1/s]
SpeedBottleneck findBottleneck(const RobotModel& model, const std::vector<SpeedBounds>& bounds,
                               double speed);

}  // namespace metier::motion
