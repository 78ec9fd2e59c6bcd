#pragma once

#include <Eigen/Core>
#include <span>
#include <string>
#include <vector>

#include "metier/path_evaluation/square.hpp"

namespace metier::path_evaluation {

/// Measured path of one robot around its square.
struct DrawnPath {
    /// Heading: any text; escaped for XML.
    std::string name;
    /// Square that it should follow.
    Square square;
    std::vector<Eigen::Vector3d> positions;  ///< measured positions [m], base frame, in the order
                                             ///< of time
    /// Deviations that are printed below.
    SquareMeasurement measurement;
};

/// An SVG picture with a panel for each path: above, the path on its square in mm; below, its
/// distance from the straight side along the way. Threads: any; pure.
std::string drawSvg(std::span<const DrawnPath> paths);

}  // namespace metier::path_evaluation
