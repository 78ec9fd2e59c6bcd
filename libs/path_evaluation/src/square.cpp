#include "metier/path_evaluation/square.hpp"

#include <algorithm>
#include <limits>

namespace metier::path_evaluation {

motion::Pose Square::corner(std::size_t index) const {
    const auto turn = index % kCorners;
    motion::Pose pose = start;
    if (turn == 1 || turn == 2) {
        pose.translation += side * right;
    }
    if (turn == 2 || turn == 3) {
        pose.translation += side * up;
    }
    return pose;
}

double distanceFromSegment(const Eigen::Vector3d& point, const Eigen::Vector3d& from,
                           const Eigen::Vector3d& to) {
    const Eigen::Vector3d line = to - from;
    const double length_squared = line.squaredNorm();
    if (length_squared == 0.0) {
        return (point - from).norm();
    }
    const double fraction = std::clamp((point - from).dot(line) / length_squared, 0.0, 1.0);
    return (point - from - fraction * line).norm();
}

double distanceFromOutline(const Square& square, const Eigen::Vector3d& point) {
    double nearest = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < kCorners; ++i) {
        nearest = std::min(nearest, distanceFromSegment(point, square.corner(i).translation,
                                                        square.corner(i + 1).translation));
    }
    return nearest;
}

SquareMeasurement measure(const Square& square, std::span<const Eigen::Vector3d> positions) {
    SquareMeasurement result;
    if (positions.empty()) {
        return result;
    }
    for (const auto& position : positions) {
        result.largest_deviation =
            std::max(result.largest_deviation, distanceFromOutline(square, position));
    }
    result.closure_error = (positions.back() - positions.front()).norm();
    return result;
}

}  // namespace metier::path_evaluation
