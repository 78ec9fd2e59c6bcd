#include "limits_along.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "metier/base/numbers.hpp"

namespace metier::motion {

namespace {

// The way and the places on it depend on each other; they agree after two or three rounds.
constexpr int kRounds = 8;
// Parts of the way that speeds up or brakes, each looked at with its largest speed.
constexpr int kParts = 6;
// Shares of the remaining jerk limit for an acceleration in a bend of the path; the quickest of
// these is used.
constexpr std::array kBendShares{0.35, 0.6, 0.85};
// Shares of a limit that a planned motion leaves beside what its bends take.
constexpr double kLeftAcceleration = 0.3;
constexpr double kLeftJerk = 0.3;
constexpr double kSpeedRounding = 1e-9;

void raise(double& value, double candidate) noexcept {
    value = std::max(value, candidate);
}

/// Reports whether the bend of the path around a knot speeds an axis up: braking only reduces that.
bool isDrivenOn(const std::vector<SpeedBounds>& bounds, std::size_t knot, std::size_t axis) {
    const std::size_t last = std::min(knot + 1, bounds.size() - 1);
    for (std::size_t k = knot == 0 ? 0 : knot - 1; k <= last; ++k) {
        const SpeedBound& bound = bounds[k].values[axis];
        if (bound.first * bound.second < 0) {
            return false;
        }
    }
    return true;
}

/// Limits with which a motion stands before `end`, these if they do.
ScalarLimits hardEnough(const ScalarState& state, double end, ScalarLimits limits) noexcept {
    constexpr int most = 500;
    constexpr double harder = 1.01;
    const double there = end + kSpeedRounding * std::abs(end);
    for (int i = 0; i < most && Profile::brake(state, limits).end() > there; ++i) {
        limits.acceleration *= harder;
        limits.jerk *= harder;
    }
    return limits;
}

bool covers(const ScalarLimits& limits, const ScalarLimits& used) noexcept {
    return used.acceleration <= limits.acceleration * (1 + kSpeedRounding) &&
           used.jerk <= limits.jerk * (1 + kSpeedRounding);
}

}  // namespace

LimitsAlong::Share LimitsAlong::shareOf(const SpeedBound& bound) noexcept {
    const double first = std::abs(bound.first);
    const double second = std::abs(bound.second);
    return {first / bound.acceleration, second / bound.acceleration, first / bound.jerk,
            second / bound.jerk, std::abs(bound.third) / bound.jerk};
}

LimitsAlong LimitsAlong::ofRobot(const RobotModel& model, const JointLine& line) {
    Place place;
    for (std::size_t axis = 0; axis < line.delta.size(); ++axis) {
        const JointLimits& own = model.limits(axis);
        place[axis] = shareOf({line.delta[axis], 0, 0, 0, own.acceleration, own.jerk});
    }
    return LimitsAlong(place);
}

LimitsAlong LimitsAlong::ofRobot(const RobotModel& model, const JointPath& path) {
    const CartesianLimits& own = model.cartesianLimits();
    const auto axes = axisBounds(model, path);
    std::vector<Place> places(axes.size());
    for (std::size_t k = 0; k < axes.size(); ++k) {
        for (std::size_t axis = 0; axis < model.axisCount(); ++axis) {
            places[k][axis] = shareOf(axes[k].values[axis]);
            places[k][axis].second *= isDrivenOn(axes, k, axis) ? 0 : 1;
        }
        const ToolDerivatives t = path.tool().translationAt(path.places()[k]);
        const ToolDerivatives r = path.tool().rotationAt(path.places()[k]);
        places[k][kMaxAxes] = shareOf({t.first, t.second, t.third, 0, own.acceleration, own.jerk});
        places[k][kMaxAxes + 1] =
            shareOf({r.first, r.second, r.third, 0, own.angular_acceleration, own.angular_jerk});
    }
    return {path.places(), std::move(places)};
}

LimitsAlong LimitsAlong::slowed(double factor) const {
    LimitsAlong result(*this);
    const double square = factor * factor;
    for (Place& place : result.places_) {
        for (Share& share : place) {
            share.first *= square;
            share.second *= square;
            share.jerk_first *= square * factor;
            share.jerk_second *= square * factor;
            share.jerk_third *= square * factor;
        }
    }
    return result;
}

/// The worst of each axis from one place to another, with the knots around them.
LimitsAlong::Place LimitsAlong::worst(double from, double to) const noexcept {
    if (places_.size() == 1) {
        return places_.front();
    }
    const auto first = std::upper_bound(at_.begin() + 1, at_.end() - 1, from) - 1;
    const auto last = std::lower_bound(first + 1, at_.end() - 1, to);
    const auto begin = static_cast<std::size_t>(first - at_.begin());
    const auto end = static_cast<std::size_t>(last - at_.begin());
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

/// Narrows `limits` by what a place leaves at a speed of the parameter.
void LimitsAlong::narrow(ScalarLimits& limits, const Place& place, const Use& use) noexcept {
    const double v = use.velocity;
    const auto left = [&](double limit, double bent, double least) {
        return std::max(limit - bent, least * limit);
    };
    const auto jerkLeft = [&](const Share& of) {
        return left(use.factor, of.jerk_third * v * v * v, kLeftJerk);
    };
    for (const Share& of : place) {
        limits.acceleration = std::min(
            {limits.acceleration, left(use.factor, of.second * v * v, kLeftAcceleration) / of.first,
             use.bend_share * jerkLeft(of) / (3 * of.jerk_second * v)});
    }
    for (const Share& of : place) {
        const double used =
            std::min(3 * of.jerk_second * v * limits.acceleration, use.bend_share * jerkLeft(of));
        limits.jerk = std::min(limits.jerk, (jerkLeft(of) - used) / of.jerk_first);
    }
}

ScalarLimits LimitsAlong::limitsAt(const ScalarState& state, const Use& use) const noexcept {
    ScalarLimits limits{1.0, kInfinity, kInfinity};
    narrow(limits, worst(state.position, state.position), use);
    return limits;
}

ScalarLimits LimitsAlong::limitsOf(const Profile& way, Use use) const noexcept {
    ScalarLimits limits{1.0, kInfinity, kInfinity};
    const auto include = [&](double begin, double end) {
        const double length = (end - begin) / kParts;
        for (int part = 0; part < kParts && length > 0; ++part) {
            const ScalarState from = way.at(begin + part * length);
            const ScalarState to = way.at(begin + (part + 1) * length);
            use.velocity = std::max(std::abs(from.velocity), std::abs(to.velocity));
            narrow(limits, worst(from.position, to.position), use);
        }
    };
    include(0, way.steadyFrom());
    include(way.steadyTo(), way.duration());
    return limits;
}

/// The way whose limits hold all along it.
template <typename Plan>
Profile LimitsAlong::settle(const ScalarState& state, const Use& use,
                            const Plan& plan) const noexcept {
    ScalarLimits limits = limitsAt(state, use);
    if (limits.acceleration == kInfinity || limits.jerk == kInfinity) {
        return plan({state.position, 0, 0}, {1, 1, 1});  // nothing moves
    }
    for (int round = 0; round < kRounds; ++round) {
        const Profile way = plan(state, limits);
        const ScalarLimits there = limitsOf(way, use);
        if (covers(there, limits)) {
            return way;
        }
        limits.acceleration = std::min(limits.acceleration, there.acceleration);
        limits.jerk = std::min(limits.jerk, there.jerk);
    }
    narrow(limits, worst(state.position, kInfinity), use);
    return plan(state, limits);
}

template <typename Plan>
Profile LimitsAlong::quickest(const ScalarState& state, double factor,
                              const Plan& plan) const noexcept {
    Use use{std::abs(state.velocity), factor, kBendShares.front()};
    Profile best = settle(state, use, plan);
    for (std::size_t i = 1; places_.size() > 1 && i < kBendShares.size(); ++i) {
        use.bend_share = kBendShares[i];
        const Profile profile = settle(state, use, plan);
        best = profile.duration() < best.duration() ? profile : best;
    }
    return best;
}

Profile LimitsAlong::brake(const ScalarState& state, double factor, double end) const noexcept {
    return quickest(state, factor, [&](const ScalarState& from, const ScalarLimits& limits) {
        return Profile::brake(from, hardEnough(from, end, limits));
    });
}

Profile LimitsAlong::toRest(const ScalarState& state, double target,
                            double velocity) const noexcept {
    return quickest(state, 1.0, [&](const ScalarState& from, ScalarLimits limits) {
        limits.velocity = velocity;
        return Profile::toRest(from, target, hardEnough(from, target, limits));
    });
}

}  // namespace metier::motion
