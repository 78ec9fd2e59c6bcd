#include "metier/motion/stream_follower.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "axis_follower.hpp"

namespace metier::motion {

namespace {

/// Times that differ by less are the same [s].
constexpr double kTimeRounding = 1e-9;
/// Joint positions that differ by less are the same [rad].
constexpr double kSamePlace = 1e-6;
/// Without delay: how fast the time that is played goes to that of the newest set-points: share of
/// the difference and most in a cycle, in cycles; and from how many cycles on it goes at once.
constexpr double kPull = 0.02;
constexpr double kMostPull = 0.005;
constexpr double kMostAhead = 0.75;
/// Without delay: the slowest root with which errors fade.
constexpr double kSlowestDecay = 0.5;
/// Without delay: a correction of a target by this share of a cycle's way is one of time.
constexpr double kLeap = 0.5;
/// Knots from which the stream has a velocity: that from the start to the first says nothing.
constexpr std::size_t kStartAndTwo = 3;

ScalarState axisOf(const SetPoint& point, std::size_t axis) noexcept {
    return {point.position[axis], point.velocity[axis], point.acceleration[axis]};
}

}  // namespace

Error toError(const StreamRefusal& refusal) {
    using Reason = StreamRefusal::Reason;
    const auto& [reason, axis, value, limit] = refusal;
    switch (reason) {
        case Reason::wrong_size:
            return {Errc::invalid_argument, fmt::format("{} axes, not {}", value, limit)};
        case Reason::not_finite:
            return {Errc::invalid_argument, fmt::format("axis {}: not finite", axis + 1)};
        case Reason::position_limit:
            return {Errc::out_of_range, fmt::format("axis {}: {:.4f} rad beyond limit {:.4f} rad",
                                                    axis + 1, value, limit)};
        case Reason::jump:
            return {Errc::out_of_range, fmt::format("axis {}: jump of {:.4f} rad over limit {:.4f}"
                                                    " rad",
                                                    axis + 1, value, limit)};
        case Reason::not_later:
            return {Errc::invalid_argument,
                    fmt::format("set-point time {:.6f} s is not after {:.6f} s", value, limit)};
        case Reason::timed_out:
            return {Errc::timeout, fmt::format("the stream was silent for {:.3f} s, limit {:.3f} s",
                                               value, limit)};
    }
    return {Errc::internal, "unknown stream refusal"};
}

Result<StreamFollower> StreamFollower::create(const RobotModel& model, const StreamOptions& options,
                                              const JointVector& start) {
    if (start.size() != model.axisCount() || !start.allFinite()) {
        return fail(Errc::invalid_argument,
                    fmt::format("start is not {} finite joint values", model.axisCount()));
    }
    if (!(options.cycle.count() > 0) || options.stale_cycles < 1 || !(options.jump_factor > 0) ||
        !(options.jerk_factor > 0)) {
        return fail(Errc::invalid_argument,
                    fmt::format("stream options: cycle {} s, stale after {} cycles, jump factor {},"
                                " jerk factor {}: one is not over 0",
                                options.cycle.count(), options.stale_cycles, options.jump_factor,
                                options.jerk_factor));
    }
    if (!(options.braking_factor >= 1)) {
        return fail(
            Errc::invalid_argument,
            fmt::format("stream options: braking factor {} is below 1", options.braking_factor));
    }
    if (options.playout_delay_cycles < 0 || options.extrapolated_cycles < 0 ||
        !(options.standing_speed >= 0)) {
        return fail(Errc::invalid_argument,
                    fmt::format("stream options: playout delay {} cycles, extrapolated {} cycles, "
                                "standing speed {} rad/s: one is below 0",
                                options.playout_delay_cycles, options.extrapolated_cycles,
                                options.standing_speed));
    }
    return StreamFollower(model, options, start);
}

StreamFollower::StreamFollower(const RobotModel& model, const StreamOptions& options,
                               const JointVector& start) noexcept
    : options_(options), now_{start, JointVector(start.size()), JointVector(start.size())} {
    for (std::size_t i = 0; i < start.size(); ++i) {
        limits_[i] = model.limits(i);
        limits_[i].jerk *= options.jerk_factor;
    }
}

FollowerLimits StreamFollower::limitsOf(std::size_t axis) const noexcept {
    return {limits_[axis], options_.braking_factor * limits_[axis].acceleration};
}

const StreamFollower::Knot& StreamFollower::knot(std::size_t age) const noexcept {
    return knots_[(newest_ + kKnots - age) % kKnots];
}

std::optional<StreamRefusal> StreamFollower::check(const JointVector& position,
                                                   double time) const noexcept {
    using Reason = StreamRefusal::Reason;
    if (state_ == State::stopping || state_ == State::timed_out) {
        const double cycle = options_.cycle.count();
        return StreamRefusal{Reason::timed_out, 0, silent_cycles_ * cycle,
                             options_.stale_cycles * cycle};
    }
    const std::size_t axes = now_.position.size();
    if (position.size() != axes) {
        return StreamRefusal{Reason::wrong_size, 0, static_cast<double>(position.size()),
                             static_cast<double>(axes)};
    }
    const bool first = knot_count_ == 0;
    if (!std::isfinite(time) || (!first && time <= knot(0).time)) {
        return StreamRefusal{Reason::not_later, 0, time, first ? 0.0 : knot(0).time};
    }
    const JointVector& before = first ? now_.position : knot(0).position;
    const double between = first
                               ? options_.cycle.count() * std::max(1, options_.playout_delay_cycles)
                               : time - knot(0).time;
    for (std::size_t i = 0; i < axes; ++i) {
        if (!std::isfinite(position[i])) {
            return StreamRefusal{Reason::not_finite, i, position[i], 0};
        }
        const double bounded = std::clamp(position[i], limits_[i].lower, limits_[i].upper);
        if (position[i] != bounded) {
            return StreamRefusal{Reason::position_limit, i, position[i], bounded};
        }
        const double jump = std::abs(position[i] - before[i]);
        const double limit = options_.jump_factor * limits_[i].velocity * between;
        if (jump > limit) {
            return StreamRefusal{Reason::jump, i, jump, limit};
        }
    }
    return std::nullopt;
}

void StreamFollower::store(const JointVector& position, double time) noexcept {
    newest_ = (newest_ + 1) % kKnots;
    knots_[newest_] = {time, position};
    knot_count_ = std::min(knot_count_ + 1, kKnots);
}

std::optional<StreamRefusal> StreamFollower::accept(const JointVector& position,
                                                    Seconds intended_time, Seconds now) noexcept {
    const double time = intended_time.count();
    if (auto refusal = check(position, time)) {
        return refusal;
    }
    if (knot_count_ == 0) {
        offset_ = now.count() - time;
        const int cycles = std::max(1, options_.playout_delay_cycles);
        store(now_.position, time - options_.cycle.count() * cycles);
        played_ = time - options_.cycle.count();
        targets_.fill(now_.position);
    } else if (!withoutDelay()) {
        waitFor(time, now.count());
    }
    store(position, time);
    fresh_ = true;
    state_ = State::following;
    return std::nullopt;
}

/// A set-point that is later than it should be played: the rest is played as much later.
void StreamFollower::waitFor(double time, double now) noexcept {
    const double earliest =
        now - options_.cycle.count() * (options_.playout_delay_cycles - 1) - time;
    offset_ = std::max(offset_, earliest);
}

Seconds StreamFollower::lagOf(Seconds intended_time, Seconds now) const noexcept {
    return knot_count_ == 0 || withoutDelay() ? Seconds(0) : intended_time + Seconds(offset_) - now;
}

void StreamFollower::skipRest(Seconds intended_time, Seconds now) noexcept {
    if (lagOf(intended_time, now).count() <= 0 || state_ != State::following) {
        return;
    }
    const double delay = options_.cycle.count() * options_.playout_delay_cycles;
    const double played = now.count() - delay - offset_;
    if (onlyRestIsLeft(played)) {
        const double to = std::min(intended_time.count() - delay, knot(0).time);
        offset_ -= std::max(0.0, to - played);
    }
}

bool StreamFollower::onlyRestIsLeft(double played) const noexcept {
    if (!atRest()) {
        return false;
    }
    for (std::size_t age = 0; age < knot_count_; ++age) {
        if (maxDifference(knot(age).position, now_.position) > kSamePlace) {
            return false;
        }
        if (knot(age).time <= played) {
            break;  // the older ones are behind
        }
    }
    return true;
}

double StreamFollower::longestBridge() const noexcept {
    return withoutDelay() ? options_.extrapolated_cycles * options_.cycle.count() : 0.0;
}

bool StreamFollower::standing() const noexcept {
    if (knot_count_ < kStartAndTwo) {
        return true;
    }
    for (std::size_t i = 0; i < now_.position.size(); ++i) {
        if (std::abs(slope(0, i)) > options_.standing_speed) {
            return false;
        }
    }
    return true;
}

JointVector StreamFollower::bridged(double time) const noexcept {
    JointVector position = knot(0).position;
    const double ahead = time - knot(0).time;
    if (ahead > longestBridge() + kTimeRounding || knot_count_ < kStartAndTwo) {
        return position;
    }
    for (std::size_t i = 0; i < position.size(); ++i) {
        const double there = position[i] + goingOn(i, ahead);
        position[i] = std::clamp(there, limits_[i].lower, limits_[i].upper);
    }
    return position;
}

double StreamFollower::goingOn(std::size_t axis, double ahead) const noexcept {
    const double last = slope(0, axis);
    if (knot_count_ < kStartAndTwo + 1) {
        return last * ahead;
    }
    const double step = knot(0).time - knot(1).time;
    const double step_before = knot(1).time - knot(2).time;
    const double before = (knot(1).position[axis] - knot(2).position[axis]) / step_before;
    const double acceleration = std::clamp(2 * (last - before) / (step + step_before),
                                           -limits_[axis].acceleration, limits_[axis].acceleration);
    const double velocity = last + acceleration * step / 2;
    if (velocity * last <= 0) {
        return 0.0;
    }
    const double time =
        velocity * acceleration < 0 ? std::min(ahead, -velocity / acceleration) : ahead;
    return (velocity + acceleration * time / 2) * time;
}

double StreamFollower::slope(std::size_t age, std::size_t axis) const noexcept {
    const std::size_t newer = age == 0 ? 0 : age - 1;
    const std::size_t older = std::min(age + 1, knot_count_ - 1);
    const double between = knot(newer).time - knot(older).time;
    return between > 0 ? (knot(newer).position[axis] - knot(older).position[axis]) / between : 0.0;
}

JointVector StreamFollower::play(double time) const noexcept {
    if (time >= knot(0).time || knot_count_ < 2) {
        return bridged(time);
    }
    std::size_t age = 1;
    while (age + 1 < knot_count_ && knot(age).time > time) {
        ++age;
    }
    const Knot& from = knot(age);
    const Knot& to = knot(age - 1);
    const double between = to.time - from.time;
    const double u = std::clamp((time - from.time) / between, 0.0, 1.0);
    JointVector position = from.position;
    for (std::size_t i = 0; i < position.size(); ++i) {
        const double m0 = slope(age, i) * between;
        const double m1 = slope(age - 1, i) * between;
        const double rise = to.position[i] - from.position[i];
        position[i] += u * (m0 + u * (3 * rise - 2 * m0 - m1 + u * (m0 + m1 - 2 * rise)));
    }
    return position;
}

TargetStates StreamFollower::statesOf(const Targets& targets, std::size_t axis) const noexcept {
    const double cycle = options_.cycle.count();
    const auto velocity = [&](std::size_t age) {
        return (targets[age][axis] - targets[age + 1][axis]) / cycle;
    };
    const auto state = [&](std::size_t age) {
        return ScalarState{targets[age][axis], velocity(age),
                           (velocity(age) - velocity(age + 1)) / cycle};
    };
    const double acceleration_change = velocity(0) - 2 * velocity(1) + velocity(2);
    if (!withoutDelay()) {
        return {state(1), state(0)};
    }
    if (std::abs(acceleration_change) <= (1 + kTimeRounding) * limits_[axis].jerk * cycle * cycle) {
        return {state(1), state(0), kSlowestDecay};
    }
    const double mean = (velocity(0) + velocity(1) + velocity(2)) / 3;
    const double now = targets[0][axis];
    return {{now - mean * cycle, mean, 0}, {now, mean, 0}, kSlowestDecay};
}

void StreamFollower::follow(const Targets& targets) noexcept {
    const double cycle = options_.cycle.count();
    for (std::size_t i = 0; i < now_.position.size(); ++i) {
        take(i, followTarget(axisOf(now_, i), statesOf(targets, i), limitsOf(i), cycle));
    }
}

void StreamFollower::take(std::size_t axis, const ScalarState& next) noexcept {
    const JointLimits& limits = limits_[axis];
    now_.position[axis] =
        std::clamp(next.position, limits.lower, limits.upper);  // removes rounding errors
    now_.velocity[axis] = next.velocity;
    now_.acceleration[axis] = next.acceleration;
}

/// All axes come to rest at one time: they stay on their line.
void StreamFollower::startBraking() noexcept {
    const double cycle = options_.cycle.count();
    double longest = 0;
    for (std::size_t i = 0; i < now_.position.size(); ++i) {
        longest = std::max(longest, brakeProfile(axisOf(now_, i), limits_[i], cycle).duration());
    }
    for (std::size_t i = 0; i < now_.position.size(); ++i) {
        brakes_[i] = {brakeWithin(longest, axisOf(now_, i), limits_[i], cycle), 0};
    }
}

void StreamFollower::brake() noexcept {
    const double cycle = options_.cycle.count();
    for (std::size_t i = 0; i < now_.position.size(); ++i) {
        auto& brake = brakes_[i];
        ++brake.cycles;
        const double position = brake.profile.at(brake.cycles * cycle).position;
        const ScalarState next = stepTo(position, axisOf(now_, i), limitsOf(i), cycle);
        take(i, next);
        if (next.position != position) {  // the finite differences do not allow it
            brake = {brakeProfile(next, limits_[i], cycle), 0};
        }
    }
}

void StreamFollower::stop() noexcept {
    if (state_ == State::waiting || state_ == State::following) {
        startBraking();
        state_ = State::stopping;
    }
}

SetPoint StreamFollower::next(Seconds now) noexcept {
    if (state_ == State::following && withoutDelay()) {
        playNewest();
    } else if (state_ == State::following) {
        playAt(now.count());
    } else if (state_ != State::waiting) {
        brake();
    }
    if (state_ == State::stopping && atRest()) {
        state_ = State::timed_out;
    }
    return now_;
}

void StreamFollower::playAt(double now) noexcept {
    const double cycle = options_.cycle.count();
    const double time = now - cycle * options_.playout_delay_cycles - offset_;
    if (time <= knot(0).time + kTimeRounding) {
        silent_cycles_ = 0;
        follow({play(time), play(time - cycle), play(time - 2 * cycle), play(time - 3 * cycle)});
        return;
    }
    brakeForSilence();
}

/// Nothing to play: brakes at once, goes on if the stream comes back in time.
void StreamFollower::brakeForSilence() noexcept {
    if (silent_cycles_ == 0) {
        startBraking();
    }
    ++missed_;
    ++silent_cycles_;
    state_ = silent_cycles_ >= options_.stale_cycles ? State::stopping : state_;
    brake();
}

void StreamFollower::playNewest() noexcept {
    const double cycle = options_.cycle.count();
    double time = played_ + cycle;
    if (std::exchange(fresh_, false)) {
        const double ahead = knot(0).time - time;
        const bool lost = ahead > kMostAhead * cycle || -ahead > longestBridge() + cycle;
        played_ += lost ? ahead : 0.0;
        time += lost ? ahead : std::clamp(kPull * ahead, -kMostPull * cycle, kMostPull * cycle);
    }
    correctTargets();
    played_ = time;
    std::copy_backward(targets_.begin(), targets_.end() - 1, targets_.end());
    targets_[0] = play(time);
    if (time <= knot(0).time + longestBridge() + kTimeRounding || standing()) {
        silent_cycles_ = 0;
        follow(targets_);
        return;
    }
    brakeForSilence();
}

/// Corrects the targets by the stream's position that is known now for the time played last. A
/// difference that is a large part of a cycle's way shifts all targets; a smaller one is noise.
void StreamFollower::correctTargets() noexcept {
    const double cycle = options_.cycle.count();
    const JointVector known = play(played_);
    for (std::size_t i = 0; i < known.size(); ++i) {
        const double off = known[i] - targets_[0][i];
        const double way = std::abs(targets_[0][i] - targets_[3][i]) / 3;
        if (std::abs(off) > kLeap * way + limits_[i].jerk * cycle * cycle * cycle) {
            for (JointVector& target : targets_) {
                target[i] += off;
            }
        }
    }
}

bool StreamFollower::atRest() const noexcept {
    constexpr double rest = 1e-6;
    return std::all_of(now_.velocity.begin(), now_.velocity.end(),
                       [](double v) { return std::abs(v) < rest; }) &&
           std::all_of(now_.acceleration.begin(), now_.acceleration.end(),
                       [](double a) { return std::abs(a) < 1e3 * rest; });
}

}  // namespace metier::motion
