#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "metier/motion/robot_model.hpp"

namespace metier::motion {

/// Two links and how far their capsules are apart [m]; negative: how deep they overlap.
struct LinkPair {
    std::size_t first = 0;  ///< 0: the base, i: what axis i moves
    std::size_t second = 0;
    double distance = 0;
};

/// Checks whether links of an arm touch each other, by the capsules of its model.
///
/// Links fewer than three joints apart are not compared: they touch by construction. Nor are the
/// pairs that the model names.
/// Threading: immutable, any thread; checking does not allocate.
class SelfCollision {
public:
    explicit SelfCollision(const RobotModel& model);

    std::size_t pairCount() const noexcept { return pairs_.size(); }
    /// The pair that is nearest, or overlaps deepest; none without capsules.
    /// \param q [rad], size axisCount()
    std::optional<LinkPair> nearest(const JointVector& q) const noexcept;
    /// "base", or the joint's name.
    std::string linkName(std::size_t link) const;

private:
    struct Pair {
        std::size_t first;
        std::size_t second;
    };

    Kinematics kinematics_;
    std::vector<Capsule> capsules_;
    std::vector<std::string> names_;
    std::vector<Pair> pairs_;  ///< pairs of indices of capsules_
};

/// Distance of two line segments [m].
double segmentDistance(const Eigen::Vector3d& a0, const Eigen::Vector3d& a1,
                       const Eigen::Vector3d& b0, const Eigen::Vector3d& b1) noexcept;

}  // namespace metier::motion
