#include "metier/motion/stream_follower.hpp"

#include <algorithm>
#include <cmath>

#include "axis_follower.hpp"

namespace metier::motion {

namespace {

/// Times that differ by less are the same [s].
constexpr double kTimeRounding = 1e-9;

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
    if (options.cycle.count() <= 0 || options.playout_delay_cycles < 1 ||
        options.stale_cycles < 1 || !(options.jump_factor > 0) || !(options.jerk_factor > 0)) {
        return fail(Errc::invalid_argument,
                    fmt::format("stream options: cycle {} s, playout delay {} cycles, stale after "
                                "{} cycles, jump factor {}, jerk factor {}: one is not over 0",
                                options.cycle.count(), options.playout_delay_cycles,
                                options.stale_cycles, options.jump_factor, options.jerk_factor));
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
    if (!first && !(time > knot(0).time)) {
        return StreamRefusal{Reason::not_later, 0, time, knot(0).time};
    }
    const JointVector& before = first ? now_.position : knot(0).position;
    const double between =
        first ? options_.cycle.count() * options_.playout_delay_cycles : time - knot(0).time;
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
    const double cycle = options_.cycle.count();
    const double earliest = now.count() - cycle * (options_.playout_delay_cycles - 1) - time;
    if (knot_count_ == 0) {
        offset_ = now.count() - time;
        store(now_.position, time - cycle * options_.playout_delay_cycles);
    } else if (offset_ < earliest) {
        offset_ = earliest;  // later than it should be played: play the rest as much later
    }
    store(position, time);
    state_ = State::following;
    ++accepted_;
    return std::nullopt;
}

double StreamFollower::slope(std::size_t age, std::size_t axis) const noexcept {
    const std::size_t newer = age == 0 ? 0 : age - 1;
    const std::size_t older = std::min(age + 1, knot_count_ - 1);
    const double between = knot(newer).time - knot(older).time;
    return between > 0 ? (knot(newer).position[axis] - knot(older).position[axis]) / between : 0.0;
}

JointVector StreamFollower::play(double time) const noexcept {
    if (time >= knot(0).time || knot_count_ < 2) {
        return knot(0).position;
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

void StreamFollower::follow(const Targets& targets) noexcept {
    const double cycle = options_.cycle.count();
    for (std::size_t i = 0; i < now_.position.size(); ++i) {
        const auto velocity = [&](std::size_t age) {
            return (targets[age][i] - targets[age + 1][i]) / cycle;
        };
        const auto state = [&](std::size_t age) {
            return ScalarState{targets[age][i], velocity(age),
                               (velocity(age) - velocity(age + 1)) / cycle};
        };
        const ScalarState next =
            followTarget(axisOf(now_, i), {state(1), state(0)}, limits_[i], cycle);
        now_.position[i] = next.position;
        now_.velocity[i] = next.velocity;
        now_.acceleration[i] = next.acceleration;
    }
}

void StreamFollower::startBraking() noexcept {
    const double cycle = options_.cycle.count();
    for (std::size_t i = 0; i < now_.position.size(); ++i) {
        brakes_[i] = brakeProfile(axisOf(now_, i), limits_[i], cycle);
    }
    brake_cycles_ = 0;
}

void StreamFollower::brake() noexcept {
    const double cycle = options_.cycle.count();
    ++brake_cycles_;
    for (std::size_t i = 0; i < now_.position.size(); ++i) {
        const double position = brakes_[i].at(brake_cycles_ * cycle).position;
        const double velocity = (position - now_.position[i]) / cycle;
        now_.acceleration[i] = (velocity - now_.velocity[i]) / cycle;
        now_.velocity[i] = velocity;
        now_.position[i] = position;
    }
}

void StreamFollower::stop() noexcept {
    if (state_ == State::waiting || state_ == State::following) {
        startBraking();
        state_ = State::stopping;
    }
}

SetPoint StreamFollower::next(Seconds now) noexcept {
    if (state_ == State::following) {
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
    // Nothing to play: brake at once, go on if the stream comes back in time.
    if (silent_cycles_ == 0) {
        startBraking();
    }
    ++missed_;
    ++silent_cycles_;
    state_ = silent_cycles_ >= options_.stale_cycles ? State::stopping : state_;
    brake();
}

bool StreamFollower::atRest() const noexcept {
    constexpr double rest = 1e-6;
    return std::all_of(now_.velocity.begin(), now_.velocity.end(),
                       [](double v) { return std::abs(v) < rest; }) &&
           std::all_of(now_.acceleration.begin(), now_.acceleration.end(),
                       [](double a) { return std::abs(a) < 1e3 * rest; });
}

}  // namespace metier::motion
