#include "metier/motion/profile.hpp"

#include <algorithm>
#include <cmath>

namespace metier::motion {

namespace {

constexpr int kMostBisections = 100;

ScalarState advance(const ScalarState& state, double jerk, double time) noexcept {
    const double a = state.acceleration;
    const double v = state.velocity;
    return {state.position + time * (v + time * (a / 2 + time * jerk / 6)),
            v + time * (a + time * jerk / 2), a + time * jerk};
}

/// Durations and jerks of a change of velocity that ends without acceleration.
struct VelocityChange {
    std::array<double, 3> duration{};
    std::array<double, 3> jerk{};
};

/// Upward change: jerk up (or down from too much), hold, jerk down.
/// `v` and `a` are such that letting go of `a` at once ends at or below `to`.
VelocityChange raiseVelocity(double v, double a, double to, const ScalarLimits& limits) noexcept {
    const double j = limits.jerk;
    const double free_peak = std::sqrt(std::max(0.0, j * (to - v) + a * a / 2));
    VelocityChange change;
    if (free_peak <= limits.acceleration || free_peak <= a) {
        const double peak = std::max(free_peak, a);
        change.duration = {(peak - a) / j, 0.0, peak / j};
        change.jerk = {j, 0.0, -j};
        return change;
    }
    const double peak = limits.acceleration;
    const double ramp = std::abs(peak - a) / j;
    const double gained = (a + peak) / 2 * ramp + peak * peak / (2 * j);
    change.duration = {ramp, std::max(0.0, (to - v - gained) / peak), peak / j};
    change.jerk = {a > peak ? -j : j, 0.0, -j};
    return change;
}

VelocityChange planVelocityChange(const ScalarState& state, double to,
                                  const ScalarLimits& limits) noexcept {
    const double a = state.acceleration;
    const double settled = state.velocity + a * std::abs(a) / (2 * limits.jerk);
    if (settled <= to) {
        return raiseVelocity(state.velocity, a, to, limits);
    }
    VelocityChange change = raiseVelocity(-state.velocity, -a, -to, limits);
    for (double& jerk : change.jerk) {
        jerk = -jerk;
    }
    return change;
}

ScalarState apply(ScalarState state, const VelocityChange& change) noexcept {
    for (std::size_t i = 0; i < change.duration.size(); ++i) {
        state = advance(state, change.jerk[i], change.duration[i]);
    }
    return state;
}

/// End position of the motion that goes to velocity `peak` and then straight to rest.
double endWithPeak(const ScalarState& start, double peak, const ScalarLimits& limits) noexcept {
    ScalarState state = apply(start, planVelocityChange(start, peak, limits));
    state.velocity = peak;
    state.acceleration = 0;
    return apply(state, planVelocityChange(state, 0.0, limits)).position;
}

/// The peak velocity with which the motion ends at `target`, within the velocity limit.
double findPeak(const ScalarState& start, double target, const ScalarLimits& limits) noexcept {
    double low = -limits.velocity;
    double high = limits.velocity;
    for (int i = 0; i < kMostBisections && high - low > 1e-16 * limits.velocity; ++i) {
        const double middle = low + (high - low) / 2;
        (endWithPeak(start, middle, limits) < target ? low : high) = middle;
    }
    return low + (high - low) / 2;
}

}  // namespace

void Profile::append(double duration, double jerk) noexcept {
    if (duration <= 0) {
        return;
    }
    pieces_[piece_count_++] = {duration, jerk, now_};
    now_ = advance(now_, jerk, duration);
    duration_ += duration;
}

void Profile::changeVelocity(double to_velocity, const ScalarLimits& limits) noexcept {
    const VelocityChange change = planVelocityChange(now_, to_velocity, limits);
    for (std::size_t i = 0; i < change.duration.size(); ++i) {
        append(change.duration[i], change.jerk[i]);
    }
    now_.velocity = to_velocity;
    now_.acceleration = 0;
}

Profile Profile::toRest(const ScalarState& start, double target,
                        const ScalarLimits& limits) noexcept {
    Profile profile;
    profile.now_ = start;
    if (start.position == target && start.velocity == 0 && start.acceleration == 0) {
        profile.end_ = target;
        return profile;
    }
    double peak = limits.velocity;
    double cruise = target - endWithPeak(start, peak, limits);
    if (cruise < 0) {
        peak = -limits.velocity;
        cruise = endWithPeak(start, peak, limits) - target;
    }
    const bool reaches_limit = cruise >= 0;
    profile.changeVelocity(reaches_limit ? peak : findPeak(start, target, limits), limits);
    profile.steady_from_ = profile.duration_;
    if (reaches_limit) {
        profile.append(cruise / limits.velocity, 0.0);
    }
    profile.steady_to_ = profile.duration_;
    profile.changeVelocity(0.0, limits);
    profile.end_ = target;
    return profile;
}

Profile Profile::brake(const ScalarState& start, const ScalarLimits& limits) noexcept {
    Profile profile;
    profile.now_ = start;
    profile.changeVelocity(0.0, limits);
    profile.steady_from_ = profile.steady_to_ = profile.duration_;
    profile.end_ = profile.now_.position;
    return profile;
}

Profile Profile::slowed(double factor) const noexcept {
    Profile slow(*this);
    for (Piece& piece : slow.pieces_) {
        piece.duration *= factor;
        piece.jerk /= factor * factor * factor;
        piece.start.velocity /= factor;
        piece.start.acceleration /= factor * factor;
    }
    slow.duration_ *= factor;
    slow.steady_from_ *= factor;
    slow.steady_to_ *= factor;
    return slow;
}

ScalarState Profile::at(double time) const noexcept {
    double local = std::max(time, 0.0);
    for (std::size_t i = 0; i < piece_count_ && time < duration_; ++i) {
        if (local < pieces_[i].duration) {
            return advance(pieces_[i].start, pieces_[i].jerk, local);
        }
        local -= pieces_[i].duration;
    }
    return {end_, 0.0, 0.0};
}

double Profile::jerkAt(double time) const noexcept {
    double local = std::max(time, 0.0);
    for (std::size_t i = 0; i < piece_count_; ++i) {
        if (local < pieces_[i].duration) {
            return pieces_[i].jerk;
        }
        local -= pieces_[i].duration;
    }
    return 0.0;
}

}  // namespace metier::motion
