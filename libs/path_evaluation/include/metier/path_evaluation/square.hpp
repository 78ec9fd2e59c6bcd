#pragma once

#include <Eigen/Core>
#include <span>

#include "metier/motion/pose.hpp"

namespace metier::path_evaluation {

/// Number of corners; a lap ends at the first one.
inline constexpr std::size_t kCorners = 4;

/// A square that stands upright in the robot's base frame; the tool keeps its orientation on it.
struct Square {
    /// First corner, lower left seen from the robot's base: base_from_tool.
    motion::Pose start;
    /// Unit vectors of the lower and of the left side, in the base frame. `up` is the base's z
    /// axis.
    Eigen::Vector3d right = Eigen::Vector3d::UnitY();
    Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
    /// Length of a side [m], > 0.
    double side = 0.1;

    /// Pose at a corner: 0 start, 1 right, 2 upper right, 3 upper left; 4 is 0 again.
    motion::Pose corner(std::size_t index) const;
};

/// Distance of a point from a straight line between two points [m].
double distanceFromSegment(const Eigen::Vector3d& point, const Eigen::Vector3d& from,
                           const Eigen::Vector3d& to);

/// Distance of a point from the nearest side [m].
double distanceFromOutline(const Square& square, const Eigen::Vector3d& point);

/// Measured deviations of one robot's path from its square.
struct SquareMeasurement {
    double largest_deviation = 0;  ///< largest distance from the straight sides [m]
    double closure_error = 0;      ///< distance from the first to the last position [m]
};

/// Measures positions [m, base frame] taken along the laps, from the first corner back to it.
/// No positions: zeros.
SquareMeasurement measure(const Square& square, std::span<const Eigen::Vector3d> positions);

}  // namespace metier::path_evaluation
