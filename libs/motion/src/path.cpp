#include "path.hpp"

#include <algorithm>
#include <array>

namespace metier::motion {

namespace {

constexpr std::size_t kStencil = 5;

/// Factors of five values with which they sum up to their value and first three derivatives.
using Weights = std::array<std::array<double, kStencil>, 4>;

/// Weights of values at `places`, which are distances from the place in question: derivatives of
/// the polynomial through them (Fornberg, Mathematics of Computation 51, 1988, pp. 699-706).
Weights weightsOf(const std::array<double, kStencil>& places) noexcept {
    Weights w{};
    w[0][0] = 1;
    double before = 1;
    for (std::size_t n = 1; n < kStencil; ++n) {
        double product = 1;
        const std::size_t highest = std::min<std::size_t>(n, 3);
        for (std::size_t v = 0; v < n; ++v) {
            const double distance = places[n] - places[v];
            product *= distance;
            if (v + 1 == n) {
                for (std::size_t d = highest; d > 0; --d) {
                    w[d][n] = before / product *
                              (static_cast<double>(d) * w[d - 1][v] - places[v] * w[d][v]);
                }
                w[0][n] = -before / product * places[v] * w[0][v];
            }
            for (std::size_t d = highest; d > 0; --d) {
                w[d][v] = (places[n] * w[d][v] - static_cast<double>(d) * w[d - 1][v]) / distance;
            }
            w[0][v] *= places[n] / distance;
        }
        before = product;
    }
    return w;
}

JointDerivatives derivativesAt(const std::vector<double>& places,
                               const std::vector<JointVector>& knots, std::size_t k) {
    const std::size_t begin = std::min(k < 2 ? 0 : k - 2, knots.size() - kStencil);
    std::array<double, kStencil> around{};
    for (std::size_t n = 0; n < kStencil; ++n) {
        around[n] = places[begin + n] - places[k];
    }
    const Weights w = weightsOf(around);
    const JointVector zero(knots[k].size());
    JointDerivatives result{zero, zero, zero};
    for (std::size_t n = 0; n < kStencil; ++n) {
        // Differences, so that nothing is lost beside a large joint position.
        const auto rise = knots[begin + n].view() - knots[k].view();
        result.first.view() += w[1][n] * rise;
        result.second.view() += w[2][n] * rise;
        result.third.view() += w[3][n] * rise;
    }
    return result;
}

}  // namespace

PathPoint JointLine::at(double s) const noexcept {
    PathPoint point{from, delta, JointVector(from.size())};
    point.q.view() += s * delta.view();
    return point;
}

JointPath::JointPath(FlangePath flange, std::vector<double> places, std::vector<JointVector> knots)
    : flange_(std::move(flange)), places_(std::move(places)), knots_(std::move(knots)) {
    derivatives_.reserve(knots_.size());
    for (std::size_t k = 0; k < knots_.size(); ++k) {
        derivatives_.push_back(derivativesAt(places_, knots_, k));
    }
}

PathPoint JointPath::interpolate(double s) const noexcept {
    const auto after = std::upper_bound(places_.begin() + 1, places_.end() - 1, s);
    const auto k = static_cast<std::size_t>(after - places_.begin()) - 1;
    const double h = places_[k + 1] - places_[k];
    const double u = std::clamp((s - places_[k]) / h, 0.0, 1.0);
    const std::size_t axes = knots_[k].size();
    PathPoint point{JointVector(axes), JointVector(axes), JointVector(axes)};
    for (std::size_t i = 0; i < axes; ++i) {
        const double m0 = derivatives_[k].first[i] * h;
        const double m1 = derivatives_[k + 1].first[i] * h;
        const double b0 = derivatives_[k].second[i] * h * h;
        const double b1 = derivatives_[k + 1].second[i] * h * h;
        const double rise = knots_[k + 1][i] - knots_[k][i];
        const double c3 = 10 * rise - 6 * m0 - 4 * m1 - 1.5 * b0 + 0.5 * b1;
        const double c4 = -15 * rise + 8 * m0 + 7 * m1 + 1.5 * b0 - b1;
        const double c5 = 6 * rise - 3 * (m0 + m1) - 0.5 * (b0 - b1);
        point.q[i] = knots_[k][i] + u * (m0 + u * (b0 / 2 + u * (c3 + u * (c4 + u * c5))));
        point.first[i] = (m0 + u * (b0 + u * (3 * c3 + u * (4 * c4 + u * 5 * c5)))) / h;
        point.second[i] = (b0 + u * (6 * c3 + u * (12 * c4 + u * 20 * c5))) / (h * h);
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
