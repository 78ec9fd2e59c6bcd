#include "metier/path_evaluation/placement.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <vector>

#include "metier/motion/kinematics.hpp"

namespace metier::path_evaluation {
namespace {

using motion::JointVector;
using motion::Kinematics;
using std::numbers::pi;

constexpr std::size_t kPointsPerSide = 4;
constexpr double kLargestStep = 0.6;  // [rad] between neighbouring points: no change of branch

/// Centre of a candidate square in cylinder coordinates about the base's z axis.
struct Candidate {
    double azimuth = 0;  // [rad]
    double radius = 0;   // [m]
    double height = 0;   // [m]
    Eigen::Quaterniond orientation = Eigen::Quaterniond::Identity();
};

/// Tool orientations worth trying: as it is, straight down, and outward.
std::vector<Eigen::Quaterniond> orientations(const Eigen::Quaterniond& current, double azimuth) {
    const Eigen::AngleAxisd turned(azimuth, Eigen::Vector3d::UnitZ());
    return {current, turned * Eigen::AngleAxisd(pi, Eigen::Vector3d::UnitY()),
            turned * Eigen::AngleAxisd(pi / 2, Eigen::Vector3d::UnitY())};
}

/// Adds the candidates in one direction from the base.
void addCandidates(double azimuth, double reach,
                   const std::vector<Eigen::Quaterniond>& orientations,
                   std::vector<Candidate>& candidates) {
    for (double radius = 0.3; radius < 0.9; radius += 0.1) {
        for (double height = 0.1; height < 0.9; height += 0.1) {
            for (const auto& orientation : orientations) {
                candidates.push_back({azimuth, radius * reach, height * reach, orientation});
            }
        }
    }
}

std::vector<Candidate> candidates(const Kinematics& arm, const motion::Pose& now) {
    const double azimuth = std::atan2(now.translation.y(), now.translation.x());
    std::vector<Candidate> result;
    for (const double turn : {0.0, -0.5, 0.5}) {
        addCandidates(azimuth + turn, arm.reach(), orientations(now.rotation, azimuth + turn),
                      result);
    }
    return result;
}

Square squareAt(const Candidate& candidate, double side) {
    Square square;
    square.side = side;
    square.right = {-std::sin(candidate.azimuth), std::cos(candidate.azimuth), 0};
    const Eigen::Vector3d centre(candidate.radius * std::cos(candidate.azimuth),
                                 candidate.radius * std::sin(candidate.azimuth), candidate.height);
    square.start.translation = centre - 0.5 * side * (square.right + square.up);
    square.start.rotation = candidate.orientation;
    return square;
}

/// Room to the nearest joint limit: 1 in the middle of the range, 0 at a limit.
double limitRoom(const Kinematics& arm, const JointVector& q) {
    double room = 1.0;
    for (std::size_t axis = 0; axis < q.size(); ++axis) {
        const auto& limits = arm.limits(axis);
        const double half = std::min(0.5 * (limits.upper - limits.lower), pi);
        room = std::min({room, (q[axis] - limits.lower) / half, (limits.upper - q[axis]) / half});
    }
    return room;
}

/// The lowest room along the outline; nothing if the arm cannot follow it.
std::optional<double> room(const Kinematics& arm, const Square& square, JointVector reference) {
    double lowest = std::numeric_limits<double>::infinity();
    for (std::size_t point = 0; point <= kCorners * kPointsPerSide; ++point) {
        const auto corner = point / kPointsPerSide;
        const double along = static_cast<double>(point % kPointsPerSide) / kPointsPerSide;
        motion::Pose pose = square.corner(corner);
        pose.translation += along * (square.corner(corner + 1).translation - pose.translation);
        const auto solution = arm.inverse(pose, {reference, {}, std::nullopt});
        if (!solution ||
            (point > 0 && motion::maxDifference(*solution, reference) > kLargestStep)) {
            return std::nullopt;
        }
        reference = *solution;
        const double freedom = arm.smallestSingularValue(reference) / arm.reach();
        lowest = std::min(lowest, std::min(limitRoom(arm, reference), 1.0) * freedom);
    }
    return lowest;
}

}  // namespace

Result<Square> placeSquare(const motion::ChainDescription& chain, const JointVector& current,
                           double side) {
    if (current.size() != chain.joints.size() || !current.allFinite() || !(side > 0)) {
        return fail(Errc::invalid_argument,
                    fmt::format("a square of {} m for an arm of {} axes at {} joint positions",
                                side, chain.joints.size(), current.size()));
    }
    const Kinematics arm(chain);
    std::optional<Square> best;
    double best_room = 0;
    for (const auto& candidate : candidates(arm, arm.forward(current))) {
        const auto square = squareAt(candidate, side);
        if (const auto found = room(arm, square, current); found && *found > best_room) {
            best_room = *found;
            best = square;
        }
    }
    if (!best) {
        return fail(Errc::unreachable,
                    fmt::format("no place for a square of {} m within the arm's reach of {:.3f} m",
                                side, arm.reach()));
    }
    return *best;
}

}  // namespace metier::path_evaluation
