#include "path.hpp"

#include <algorithm>
#include <cmath>

namespace metier::motion {

namespace {

/// Derivative at knot k from its neighbours: fourth order inside, one-sided at the ends.
JointVector tangentAt(const std::vector<JointVector>& knots, std::size_t k) {
    const std::size_t last = knots.size() - 1;
    const auto scale = static_cast<double>(last);
    JointVector tangent(knots[k].size());
    for (std::size_t i = 0; i < tangent.size(); ++i) {
        const auto q = [&](std::size_t n) { return knots[n][i]; };
        double slope = 0;
        if (k >= 2 && k + 2 <= last) {
            slope = (q(k - 2) - 8 * q(k - 1) + 8 * q(k + 1) - q(k + 2)) / 12;
        } else if (last >= 4) {
            const double sign = k < 2 ? 1 : -1;
            const std::size_t edge = k < 2 ? 0 : last;
            const auto inward = [&](std::size_t n) { return q(k < 2 ? edge + n : edge - n); };
            const bool at_edge = k == edge;
            slope = at_edge ? sign *
                                  (-25 * inward(0) + 48 * inward(1) - 36 * inward(2) +
                                   16 * inward(3) - 3 * inward(4)) /
                                  12
                            : sign *
                                  (-3 * inward(0) - 10 * inward(1) + 18 * inward(2) -
                                   6 * inward(3) + inward(4)) /
                                  12;
        }
        tangent[i] = slope * scale;
    }
    return tangent;
}

}  // namespace

PathPoint JointLine::at(double s) const noexcept {
    PathPoint point{from, delta, JointVector(from.size())};
    point.q.view() += s * delta.view();
    return point;
}

JointPath::JointPath(FlangePath flange, std::vector<JointVector> knots)
    : flange_(std::move(flange)), knots_(std::move(knots)) {
    tangents_.reserve(knots_.size());
    for (std::size_t k = 0; k < knots_.size(); ++k) {
        tangents_.push_back(tangentAt(knots_, k));
    }
}

PathPoint JointPath::interpolate(double s) const noexcept {
    const auto count = static_cast<double>(intervals());
    const double scaled = std::clamp(s, 0.0, 1.0) * count;
    const std::size_t k = std::min(static_cast<std::size_t>(scaled), intervals() - 1);
    const double u = scaled - static_cast<double>(k);
    const std::size_t axes = knots_[k].size();
    PathPoint point{JointVector(axes), JointVector(axes), JointVector(axes)};
    for (std::size_t i = 0; i < axes; ++i) {
        const double m0 = tangents_[k][i] / count;
        const double m1 = tangents_[k + 1][i] / count;
        const double rise = knots_[k + 1][i] - knots_[k][i];
        const double c2 = 3 * rise - 2 * m0 - m1;
        const double c3 = m0 + m1 - 2 * rise;
        point.q[i] = knots_[k][i] + u * (m0 + u * (c2 + u * c3));
        point.first[i] = count * (m0 + u * (2 * c2 + u * 3 * c3));
        point.second[i] = count * count * (2 * c2 + u * 6 * c3);
    }
    return point;
}

PathPoint JointPath::at(double s, const Kinematics& kinematics) const noexcept {
    PathPoint point = interpolate(s);
    const JointVector exact =
        kinematics.solutionNear(flange_.at(s), point.q, flange_.armAngleAt(s));
    if (!exact.empty()) {
        point.q = exact;
    }
    return point;
}

}  // namespace metier::motion
