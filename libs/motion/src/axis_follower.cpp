#include "axis_follower.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace metier::motion {

namespace {

/// Share of the limits that steering uses, so that rounding never breaks them; a stream that uses
/// them to the full is followed with the rounding of its own.
constexpr double kRounding = 1e-6;
constexpr double kShare = 1 - kRounding;
constexpr int kBisections = 30;
/// Share of the jerk limit for letting an error fade: the target's own motion needs some too.
constexpr double kFadingJerk = 0.7;
/// An error that is this much smaller each cycle is gone without overshoot; 0: gone at once.
constexpr std::array kDecays{0.0, 0.5, 0.7, 0.8, 0.9, 0.95};

ScalarState step(const ScalarState& now, double jerk, double cycle) noexcept {
    const double acceleration = now.acceleration + jerk * cycle;
    const double velocity = now.velocity + acceleration * cycle;
    return {now.position + velocity * cycle, velocity, acceleration};
}

/// The jerk that brings the axis to `position` in one cycle.
double jerkTo(double position, const ScalarState& now, double cycle) noexcept {
    const double velocity = (position - now.position) / cycle;
    return ((velocity - now.velocity) / cycle - now.acceleration) / cycle;
}

/// The error one cycle later if its three last values fade with a triple root at `decay`.
double decayed(const ScalarState& error, double decay, double cycle) noexcept {
    const double before = error.position - error.velocity * cycle;
    const double earlier = before - (error.velocity - error.acceleration * cycle) * cycle;
    return decay * (3 * error.position - decay * (3 * before - decay * earlier));
}

/// Reports whether an error can fade with `decay` without more than `jerk` on the way.
bool fades(ScalarState error, double decay, double jerk, double cycle) noexcept {
    constexpr int lookahead = 8;
    for (int i = 0; i < lookahead; ++i) {
        const double needed = jerkTo(decayed(error, decay, cycle), error, cycle);
        if (std::abs(needed) > jerk) {
            return false;
        }
        error = step(error, needed, cycle);
    }
    return true;
}

/// Largest acceleration of the next cycle after which the velocity still stays below the limit,
/// when it then falls by the jerk limit each cycle: after m cycles of that it is 0.
double highestAcceleration(double velocity, const ScalarLimits& limits, double cycle) noexcept {
    const double room = limits.velocity - velocity;
    if (room <= 0) {
        return room / cycle;
    }
    const double fall = limits.jerk * cycle;
    const double m = std::floor((std::sqrt(1 + 8 * room / (fall * cycle)) - 1) / 2);
    return room / (cycle * (m + 1)) + fall * m / 2;
}

/// Largest acceleration of the next cycle against `speed`: above the limit of the acceleration only
/// as far as the axis still brakes when it has fallen to that limit by the jerk limit each cycle.
double hardestBraking(double speed, const FollowerLimits& limits, double cycle) noexcept {
    const double room = speed / cycle;
    const double fall = limits.jerk * cycle;
    const double least = limits.acceleration - fall / 2;
    const double root = std::sqrt(least * least + 2 * fall * std::max(0.0, room));
    const double m = std::floor((root - least) / fall);  // cycles above the limit
    if (m < 1) {
        return limits.acceleration;
    }
    return std::min(
        {limits.deceleration, limits.acceleration + m * fall, room / m + fall * (m - 1) / 2});
}

FollowerLimits shareOf(FollowerLimits limits, double share) noexcept {
    limits.velocity *= share;
    limits.acceleration *= share;
    limits.deceleration *= share;
    limits.jerk *= share;
    return limits;
}

ScalarLimits scalarOf(const JointLimits& limits) noexcept {
    return {limits.velocity, limits.acceleration, limits.jerk};
}

/// The state at the end of the cycle from that in finite differences, which lag half a cycle.
ScalarState atInstant(const ScalarState& state, double cycle) noexcept {
    return {state.position, state.velocity + state.acceleration * cycle / 2, state.acceleration};
}

/// End position of a motion that brakes at once.
double stopPosition(const ScalarState& state, const ScalarLimits& limits, double cycle) noexcept {
    return Profile::brake(atInstant(state, cycle), limits).end();
}

/// The farthest in `direction` (1 or -1) that a motion may end that brakes at once. While it brakes
/// already, the jerk that ends the braking acts a part of a cycle sooner than atInstant() says.
double farthestStop(const ScalarState& state, double direction, const ScalarLimits& limits,
                    double cycle) noexcept {
    const double braking = std::max(0.0, -direction * state.acceleration);
    const double jerk = direction * std::min(limits.jerk, braking / cycle);
    ScalarState later = atInstant(state, cycle);
    later.acceleration += jerk * cycle;
    later.velocity += jerk * cycle * cycle / 3;
    const double end = Profile::brake(later, limits).end();
    return direction * std::max(direction * end, direction * stopPosition(state, limits, cycle));
}

struct JerkRange {
    double low;
    double high;
};

JerkRange allowedJerk(const ScalarState& now, const FollowerLimits& limits, double cycle) noexcept {
    const auto most = [&](double velocity) {
        return std::min(hardestBraking(-velocity, limits, cycle),
                        highestAcceleration(velocity, scalarOf(limits), cycle));
    };
    const double up = most(now.velocity);
    const double down = -most(-now.velocity);
    return {std::clamp((down - now.acceleration) / cycle, -limits.jerk, limits.jerk),
            std::clamp((up - now.acceleration) / cycle, -limits.jerk, limits.jerk)};
}

/// The jerk for which the growing `excess` is 0, or the nearest in the range.
template <typename Excess>
double findJerk(const JerkRange& range, const Excess& excess) noexcept {
    double low = range.low;
    double high = range.high;
    if (excess(high) <= 0) {
        return high;
    }
    for (int i = 0; i < kBisections; ++i) {
        const double middle = (low + high) / 2;
        (excess(middle) <= 0 ? low : high) = middle;
    }
    return low;
}

/// The range narrowed so that the axis can still stop before a position limit.
JerkRange beforePositionLimits(const ScalarState& now, const FollowerLimits& limits,
                               JerkRange range, double cycle) noexcept {
    const ScalarLimits used = scalarOf(shareOf(limits, kShare));
    range.high = findJerk(range, [&](double jerk) {
        return farthestStop(step(now, jerk, cycle), 1, used, cycle) - limits.upper;
    });
    range.low = -findJerk({-range.high, -range.low}, [&](double jerk) {
        return limits.lower - farthestStop(step(now, -jerk, cycle), -1, used, cycle);
    });
    return range;
}

/// Range of jerk that the limits allow, except for rounding.
JerkRange exactRange(const ScalarState& now, const FollowerLimits& limits, double cycle) noexcept {
    return beforePositionLimits(now, limits,
                                allowedJerk(now, shareOf(limits, 1 + kRounding), cycle), cycle);
}

}  // namespace

ScalarState stepTo(double position, const ScalarState& now, const FollowerLimits& limits,
                   double cycle) noexcept {
    const JerkRange range = exactRange(now, limits, cycle);
    const double jerk = jerkTo(position, now, cycle);
    ScalarState next = step(now, std::clamp(jerk, range.low, range.high), cycle);
    if (jerk >= range.low && jerk <= range.high) {
        next.position = position;
    }
    return next;
}

Profile brakeProfile(const ScalarState& now, const JointLimits& limits, double cycle) noexcept {
    return Profile::brake(
        atInstant(now, cycle),
        {kShare * limits.velocity, kShare * limits.acceleration, kShare * limits.jerk});
}

Profile brakeWithin(double duration, const ScalarState& now, const JointLimits& limits,
                    double cycle) noexcept {
    constexpr int bisections = 20;
    JointLimits used = limits;
    double low = 0.0;
    double high = 1.0;
    for (int i = 0; i < bisections; ++i) {
        const double middle = (low + high) / 2;
        used.acceleration = middle * limits.acceleration;
        used.jerk = middle * limits.jerk;
        (brakeProfile(now, used, cycle).duration() > duration ? low : high) = middle;
    }
    used.acceleration = high * limits.acceleration;
    used.jerk = high * limits.jerk;
    return brakeProfile(now, used, cycle);
}

ScalarState followTarget(const ScalarState& now, const TargetStates& targets,
                         const FollowerLimits& limits, double cycle) noexcept {
    const ScalarState& target = targets.now;
    const FollowerLimits used = shareOf(limits, kShare);
    const JerkRange range = beforePositionLimits(now, limits, allowedJerk(now, used, cycle), cycle);
    const ScalarState error{now.position - targets.before.position,
                            now.velocity - targets.before.velocity,
                            now.acceleration - targets.before.acceleration};
    const JerkRange exact = exactRange(now, limits, cycle);
    for (const double decay : kDecays) {
        if (decay > targets.slowest_decay || !fades(error, decay, kFadingJerk * used.jerk, cycle)) {
            continue;
        }
        const double position = target.position + decayed(error, decay, cycle);
        const double jerk = jerkTo(position, now, cycle);
        if (jerk >= exact.low && jerk <= exact.high) {
            ScalarState next = step(now, jerk, cycle);
            next.position = position;
            return next;
        }
        // The target's own motion needs the rest: as near as can be, the error stays small.
        return step(now, std::clamp(jerk, range.low, range.high), cycle);
    }
    // Seen from the target, with what the target's own motion leaves of the limits.
    const ScalarLimits relative{
        used.velocity,
        std::max(used.acceleration - std::abs(target.acceleration), 0.1 * used.acceleration),
        0.7 * used.jerk};
    return step(now,
                findJerk(range,
                         [&](double jerk) {
                             const ScalarState next = step(now, jerk, cycle);
                             return stopPosition(
                                 {next.position - target.position, next.velocity - target.velocity,
                                  next.acceleration - target.acceleration},
                                 relative, cycle);
                         }),
                cycle);
}

}  // namespace metier::motion
