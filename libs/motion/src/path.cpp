#include "path.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace metier::motion {

namespace {

constexpr std::size_t kStencil = 5;
/// Largest distance of the exact joint position from the interpolated one [rad].
constexpr double kLargestDeviation = 1e-3;
/// The same beside a knot, by kBesideKnot of an interval, where both begin with the same position:
/// the speeds of the axes differ little then.
constexpr double kLargestDeviationBesideKnot = 3e-9;
constexpr double kBesideKnot = 0.02;
/// Most intervals on either side of a singularity that are interpolated for it.
constexpr std::size_t kMostBeside = 16;

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
        for (std::size_t v = 0; v < n; ++v) {
            product *= places[n] - places[v];
        }
        const std::size_t highest = std::min<std::size_t>(n, 3);
        const std::size_t last = n - 1;
        for (std::size_t d = highest; d > 0; --d) {
            w[d][n] = before / product *
                      (static_cast<double>(d) * w[d - 1][last] - places[last] * w[d][last]);
        }
        w[0][n] = -before / product * places[last] * w[0][last];
        for (std::size_t v = 0; v < n; ++v) {
            const double distance = places[n] - places[v];
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

/// Numbers of which one passes 0 where the arm passes a singularity. Of six axes the determinant of
/// the Jacobian; of seven, whose arm angle is given, the sine of each axis: such arms are singular
/// where axis 2, 4 or 6 is straight.
JointVector singularityMeasures(const Kinematics& kinematics, const JointVector& q) noexcept {
    constexpr std::size_t six = 6;
    if (q.size() == six) {
        const Eigen::Matrix<double, six, six> square = kinematics.jacobian(q);
        return JointVector{square.determinant()};
    }
    JointVector sines = q;
    for (double& axis : sines) {
        axis = std::sin(axis);
    }
    return sines;
}

}  // namespace

PathPoint JointLine::at(double s) const noexcept {
    PathPoint point{from, delta, JointVector(from.size())};
    point.q.view() += s * delta.view();
    return point;
}

JointPath::JointPath(FlangePath flange, std::vector<double> places, std::vector<JointVector> knots,
                     const Kinematics& kinematics)
    : flange_(std::move(flange)), places_(std::move(places)), knots_(std::move(knots)) {
    derivatives_.reserve(knots_.size());
    for (std::size_t k = 0; k < knots_.size(); ++k) {
        derivatives_.push_back(derivativesAt(places_, knots_, k));
    }
    interpolated_.resize(knots_.size() - 1);
    for (std::size_t k = 0; k < interpolated_.size(); ++k) {
        if (passesSingularity(k, kinematics)) {
            interpolateAround(k, kinematics);
        }
    }
}

void JointPath::interpolateAround(std::size_t interval, const Kinematics& kinematics) noexcept {
    const auto leaves = [&](std::size_t k, double share) {
        const double s = places_[k] + share * (places_[k + 1] - places_[k]);
        const JointVector guess = interpolate(k, s).q;
        const JointVector exact = exactNear(guess, s, kinematics);
        return exact.empty() || maxDifference(exact, guess) > kLargestDeviationBesideKnot;
    };
    interpolated_[interval] = 1;
    const std::size_t first = interval - std::min(interval, kMostBeside);
    for (std::size_t k = interval; k > first && leaves(k - 1, 1 - kBesideKnot); --k) {
        interpolated_[k - 1] = 1;
    }
    const std::size_t last = std::min(interval + kMostBeside, interpolated_.size() - 1);
    for (std::size_t k = interval; k < last && leaves(k + 1, kBesideKnot); ++k) {
        interpolated_[k + 1] = 1;
    }
}

std::size_t JointPath::intervalOf(double s) const noexcept {
    const auto after = std::upper_bound(places_.begin() + 1, places_.end() - 1, s);
    return static_cast<std::size_t>(after - places_.begin()) - 1;
}

JointVector JointPath::exactNear(const JointVector& guess, double s,
                                 const Kinematics& kinematics) const noexcept {
    return kinematics.solutionNear(flange_.at(s), guess, flange_.armAngleAt(s));
}

double JointPath::crossingOf(std::size_t measure, std::size_t interval,
                             const Kinematics& kinematics) const noexcept {
    constexpr int halvings = 40;
    const auto is_negative = [&](const JointVector& q) {
        return singularityMeasures(kinematics, q)[measure] < 0;
    };
    double low = places_[interval];
    double high = places_[interval + 1];
    const bool rises = is_negative(knots_[interval]);
    for (int i = 0; i < halvings; ++i) {
        const double middle = (low + high) / 2;
        (is_negative(interpolate(interval, middle).q) == rises ? low : high) = middle;
    }
    return (low + high) / 2;
}

bool JointPath::passesSingularity(std::size_t interval,
                                  const Kinematics& kinematics) const noexcept {
    const JointVector from = singularityMeasures(kinematics, knots_[interval]);
    const JointVector to = singularityMeasures(kinematics, knots_[interval + 1]);
    for (std::size_t measure = 0; measure < from.size(); ++measure) {
        if ((from[measure] < 0) == (to[measure] < 0)) {
            continue;
        }
        const double s = crossingOf(measure, interval, kinematics);
        const JointVector guess = interpolate(interval, s).q;
        const JointVector exact = exactNear(guess, s, kinematics);
        if (exact.empty() || maxDifference(exact, guess) > kLargestDeviation) {
            return true;
        }
    }
    return false;
}

PathPoint JointPath::interpolate(std::size_t interval, double s) const noexcept {
    const double h = places_[interval + 1] - places_[interval];
    const double u = std::clamp((s - places_[interval]) / h, 0.0, 1.0);
    const std::size_t axes = knots_[interval].size();
    PathPoint point{JointVector(axes), JointVector(axes), JointVector(axes)};
    for (std::size_t i = 0; i < axes; ++i) {
        const double m0 = derivatives_[interval].first[i] * h;
        const double m1 = derivatives_[interval + 1].first[i] * h;
        const double b0 = derivatives_[interval].second[i] * h * h;
        const double b1 = derivatives_[interval + 1].second[i] * h * h;
        const double rise = knots_[interval + 1][i] - knots_[interval][i];
        const double c3 = 10 * rise - 6 * m0 - 4 * m1 - 1.5 * b0 + 0.5 * b1;
        const double c4 = -15 * rise + 8 * m0 + 7 * m1 + 1.5 * b0 - b1;
        const double c5 = 6 * rise - 3 * (m0 + m1) - 0.5 * (b0 - b1);
        point.q[i] = knots_[interval][i] + u * (m0 + u * (b0 / 2 + u * (c3 + u * (c4 + u * c5))));
        point.first[i] = (m0 + u * (b0 + u * (3 * c3 + u * (4 * c4 + u * 5 * c5)))) / h;
        point.second[i] = (b0 + u * (6 * c3 + u * (12 * c4 + u * 20 * c5))) / (h * h);
    }
    return point;
}

PathPoint JointPath::at(double s, const Kinematics& kinematics) const noexcept {
    const std::size_t interval = intervalOf(s);
    PathPoint point = interpolate(interval, s);
    if (interpolated_[interval] != 0) {
        return point;
    }
    const JointVector exact = exactNear(point.q, s, kinematics);
    if (!exact.empty()) {
        point.q = exact;
    }
    return point;
}

}  // namespace metier::motion
