#include "self_collision.hpp"

#include <algorithm>
#include <array>

namespace metier::motion {

namespace {

using Eigen::Vector3d;

double ratio(double numerator, double denominator) noexcept {
    constexpr double tiny = 1e-18;
    return denominator < tiny ? 0.0 : std::clamp(numerator / denominator, 0.0, 1.0);
}

bool compared(const RobotModel& model, std::size_t first, std::size_t second) {
    const auto [low, high] = std::minmax(first, second);
    return high - low >= kLeastJointsBetween &&
           std::none_of(model.notCompared().begin(), model.notCompared().end(),
                        [low = low, high = high](const UncomparedLinks& pair) {
                            return std::minmax(pair.first, pair.second) == std::minmax(low, high);
                        });
}

}  // namespace

double segmentDistance(const Vector3d& a0, const Vector3d& a1, const Vector3d& b0,
                       const Vector3d& b1) noexcept {
    const Vector3d a = a1 - a0;
    const Vector3d b = b1 - b0;
    const Vector3d between = a0 - b0;
    const double aa = a.squaredNorm();
    const double bb = b.squaredNorm();
    const double ab = a.dot(b);
    const double a_between = a.dot(between);
    const double b_between = b.dot(between);
    // Nearest point of line a to line b, then of b to that, then of a to that: each kept inside.
    double on_a = ratio(ab * b_between - a_between * bb, aa * bb - ab * ab);
    const double on_b = ratio(b_between + ab * on_a, bb);
    on_a = ratio(ab * on_b - a_between, aa);
    return (between + on_a * a - on_b * b).norm();
}

SelfCollision::SelfCollision(const RobotModel& model)
    : kinematics_(model.kinematics()), capsules_(model.capsules()), names_{"base"} {
    capsules_.resize(std::min(capsules_.size(), kMostCapsules));
    for (const JointDescription& joint : model.chain().joints) {
        names_.push_back(joint.name);
    }
    for (std::size_t i = 0; i < capsules_.size(); ++i) {
        for (std::size_t k = i + 1; k < capsules_.size(); ++k) {
            if (compared(model, capsules_[i].link, capsules_[k].link)) {
                pairs_.push_back({i, k});
            }
        }
    }
}

std::string SelfCollision::linkName(std::size_t link) const {
    return names_[link];
}

std::optional<LinkPair> SelfCollision::nearest(const JointVector& q) const noexcept {
    struct Segment {
        Vector3d from;
        Vector3d to;
    };
    std::array<Segment, kMostCapsules> segments;
    const auto frames = kinematics_.forwardAll(q);
    for (std::size_t i = 0; i < capsules_.size(); ++i) {
        const Capsule& capsule = capsules_[i];
        segments[i] = {capsule.from, capsule.to};
        if (capsule.link > 0) {
            const Pose& frame = frames[capsule.link - 1];
            segments[i] = {frame * capsule.from, frame * capsule.to};
        }
    }
    std::optional<LinkPair> nearest;
    for (const Pair& pair : pairs_) {
        const Capsule& first = capsules_[pair.first];
        const Capsule& second = capsules_[pair.second];
        const Segment& a = segments[pair.first];
        const Segment& b = segments[pair.second];
        const double distance =
            segmentDistance(a.from, a.to, b.from, b.to) - first.radius - second.radius;
        if (!nearest || distance < nearest->distance) {
            nearest = LinkPair{first.link, second.link, distance};
        }
    }
    return nearest;
}

}  // namespace metier::motion
