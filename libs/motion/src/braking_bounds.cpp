#include "braking_bounds.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace metier::motion {

namespace {

// The way to rest and the places on it depend on each other; they agree after two or three rounds.
constexpr int kRounds = 8;
// Parts of the way to rest, each looked at with its largest speed.
constexpr int kParts = 6;
// Shares of the jerk limit that an acceleration in a bend of the path may take; the quickest stop
// of these is taken.
constexpr std::array kBendShares{0.25, 0.45, 0.65};
constexpr double kStill = 1e-12;  // of the path
constexpr double kInfinity = std::numeric_limits<double>::infinity();

void raise(double& value, double candidate) noexcept {
    value = std::max(value, candidate);
}

/// The tool frame's way, by its own limits.
SpeedBound toolBound(const ToolDerivatives& d, double acceleration, double jerk) noexcept {
    return {d.first, d.second, d.third, 0, acceleration, jerk};
}

/// Whether the bend of the path around a knot drives an axis on: braking only takes that away.
bool isDrivenOn(const std::vector<JointVector>& knots, std::size_t knot, std::size_t axis) {
    const std::size_t last = knots.size() - 1;
    for (std::size_t k = knot < 2 ? 1 : knot - 1; k <= std::min(knot + 1, last - 1); ++k) {
        const double rise = knots[k + 1][axis] - knots[k - 1][axis];
        const double bend = knots[k + 1][axis] - 2 * knots[k][axis] + knots[k - 1][axis];
        if (rise * bend < 0) {
            return false;
        }
    }
    return last > 1;
}

}  // namespace

BrakingBounds::Share BrakingBounds::shareOf(const SpeedBound& bound) noexcept {
    return {bound.first / bound.acceleration, bound.second / bound.acceleration,
            bound.first / bound.jerk, bound.second / bound.jerk, bound.third / bound.jerk};
}

BrakingBounds BrakingBounds::of(const RobotModel& model, const JointLine& line) {
    BrakingBounds result;
    Place place;
    for (std::size_t axis = 0; axis < line.delta.size(); ++axis) {
        const JointLimits& own = model.limits(axis);
        place[axis] = shareOf({std::abs(line.delta[axis]), 0, 0, 0, own.acceleration, own.jerk});
    }
    result.places_.push_back(place);
    return result;
}

BrakingBounds BrakingBounds::of(const RobotModel& model, const JointPath& path) {
    BrakingBounds result;
    const CartesianLimits& own = model.cartesianLimits();
    const auto axes = axisBounds(model, path.knots());
    for (std::size_t k = 0; k < axes.size(); ++k) {
        const double s = static_cast<double>(k) / static_cast<double>(axes.size() - 1);
        Place place;
        for (std::size_t axis = 0; axis < model.axisCount(); ++axis) {
            place[axis] = shareOf(axes[k].values[axis]);
            place[axis].second *= isDrivenOn(path.knots(), k, axis) ? 0 : 1;
        }
        place[kMaxAxes] =
            shareOf(toolBound(path.tool().translationAt(s), own.acceleration, own.jerk));
        place[kMaxAxes + 1] = shareOf(
            toolBound(path.tool().rotationAt(s), own.angular_acceleration, own.angular_jerk));
        result.places_.push_back(place);
    }
    return result;
}

/// The worst of each axis from one path parameter to another, with the knots around them.
BrakingBounds::Place BrakingBounds::worst(double from, double to) const noexcept {
    const auto last = static_cast<double>(places_.size() - 1);
    const auto begin = static_cast<std::size_t>(std::clamp(from, 0.0, 1.0) * last);
    const auto end = static_cast<std::size_t>(std::ceil(std::clamp(to, 0.0, 1.0) * last));
    Place result = places_[begin];
    for (std::size_t k = begin + 1; k <= end; ++k) {
        for (std::size_t i = 0; i < result.size(); ++i) {
            raise(result[i].first, places_[k][i].first);
            raise(result[i].second, places_[k][i].second);
            raise(result[i].jerk_first, places_[k][i].jerk_first);
            raise(result[i].jerk_second, places_[k][i].jerk_second);
            raise(result[i].jerk_third, places_[k][i].jerk_third);
        }
    }
    return result;
}

/// Narrows `limits` by what a place leaves at a speed of the path parameter.
void BrakingBounds::narrow(ScalarLimits& limits, const Place& place, const Use& use) noexcept {
    const double v = use.velocity;
    for (const Share& of : place) {
        // The plan left at least half of the limits beside what its bends take.
        const double bent = std::min(of.second * v * v, use.factor / 2);
        limits.acceleration = std::min({limits.acceleration, (use.factor - bent) / of.first,
                                        use.bend_share * use.factor / (3 * of.jerk_second * v)});
    }
    for (const Share& of : place) {
        const double bent = std::min(of.jerk_third * v * v * v, use.factor / 4);
        const double used =
            std::min(3 * of.jerk_second * v * limits.acceleration, use.bend_share * use.factor);
        limits.jerk = std::min(limits.jerk, (use.factor - bent - used) / of.jerk_first);
    }
}

/// Limits that hold all along `way`, at the speeds that it has.
ScalarLimits BrakingBounds::limitsAlong(const Profile& way, Use use) const noexcept {
    ScalarLimits limits{1.0, kInfinity, kInfinity};
    for (int part = 0; part < kParts; ++part) {
        const ScalarState from = way.at(part * way.duration() / kParts);
        const ScalarState to = way.at((part + 1) * way.duration() / kParts);
        use.velocity = std::max(std::abs(from.velocity), std::abs(to.velocity));
        narrow(limits, worst(from.position, to.position), use);
    }
    return limits;
}

Profile BrakingBounds::brake(const ScalarState& state, const Use& use) const noexcept {
    ScalarLimits limits{1.0, kInfinity, kInfinity};
    narrow(limits, worst(state.position, state.position), use);
    if (limits.acceleration == kInfinity || limits.jerk == kInfinity) {
        return Profile::brake({state.position, 0, 0}, {1, 1, 1});  // nothing moves
    }
    Profile profile = Profile::brake(state, limits);
    for (int round = 0; round < kRounds; ++round) {
        const Profile longer = Profile::brake(state, limitsAlong(profile, use));
        if (longer.end() <= profile.end() + kStill) {
            return longer;
        }
        profile = longer;
    }
    narrow(limits, worst(state.position, 1.0), use);
    return Profile::brake(state, limits);
}

Profile BrakingBounds::brake(const ScalarState& state, double factor) const noexcept {
    Use use{std::abs(state.velocity), factor, kBendShares.front()};
    Profile best = brake(state, use);
    for (std::size_t i = 1; places_.size() > 1 && i < kBendShares.size(); ++i) {
        use.bend_share = kBendShares[i];
        const Profile profile = brake(state, use);
        best = profile.duration() < best.duration() ? profile : best;
    }
    return best;
}

}  // namespace metier::motion
