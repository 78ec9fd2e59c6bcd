#include "stream/stream_input.hpp"

#include <algorithm>
#include <chrono>
#include <utility>

namespace metier::robot_skills {

namespace {

// Divisor of the deviation of an arrival from its rhythm, for the correction of the set-point's
// time and of the interval.
constexpr int kTimeShare = 32;
constexpr int kIntervalShare = 1024;
// A set-point that is farther off begins another rhythm: a pause, another rate.
constexpr int kLostCycles = 4;
constexpr std::chrono::milliseconds kLongestInterval{50};
// Times farther apart than this are as far apart as this; sums of a few of them do not overflow.
constexpr std::chrono::nanoseconds kFarthest = std::chrono::hours(24 * 365 * 10);

/// `to` - `from`, which are any times.
std::chrono::nanoseconds between(UtcTime from, UtcTime to) noexcept {
    std::int64_t difference = 0;
    const bool over = __builtin_sub_overflow(to.time_since_epoch().count(),
                                             from.time_since_epoch().count(), &difference);
    const auto farthest = to < from ? -kFarthest : kFarthest;
    return over ? farthest
                : std::clamp(std::chrono::nanoseconds(UtcTime::duration(difference)), -kFarthest,
                             kFarthest);
}

}  // namespace

void StreamTimes::restart() noexcept {
    sender_start_.reset();
    sender_before_.reset();
    clock_step_ = {};
    arrival_start_.reset();
    interval_ = cycle_;
    last_arrival_ = {};
}

motion::Seconds StreamTimes::next(std::optional<UtcTime> meant_for) noexcept {
    const auto now = clock_.now();
    const bool first = !arrival_start_;
    arrival_start_ = arrival_start_.value_or(now);
    const std::chrono::nanoseconds arrival = now - *arrival_start_;
    if (meant_for && *meant_for != UtcTime::min()) {
        last_ = bySender(*meant_for, arrival, first);
        return last_;
    }
    const auto meant = first || arrivals_ == Arrivals::each ? arrival : inRhythm(arrival);
    last_ = first ? meant : std::max(meant, last_ + least_step_);
    sender_before_.reset();
    clock_step_ = {};
    return last_;
}

std::chrono::nanoseconds StreamTimes::bySender(UtcTime meant_for, std::chrono::nanoseconds arrival,
                                               bool first) noexcept {
    if (!sender_start_) {
        // An earlier target without a time is not followed at once: no axis could.
        sender_start_.emplace(meant_for, first ? arrival : std::max(arrival, last_ + cycle_));
    }
    const auto meant = between(sender_start_->first, meant_for) + sender_start_->second;
    if (sender_before_) {
        const auto step = meant - *sender_before_;
        const auto ahead = step - (arrival - sender_arrival_);
        clock_step_ = step.count() < 0 ? step : std::max(ahead, std::chrono::nanoseconds(0));
    }
    sender_before_ = meant;
    sender_arrival_ = arrival;
    return meant;
}

std::chrono::nanoseconds StreamTimes::inRhythm(std::chrono::nanoseconds arrival) noexcept {
    const auto since_last = arrival - std::exchange(last_arrival_, arrival);
    const auto expected = last_ + interval_;
    const auto off = arrival - expected;
    if (std::chrono::abs(off) > kLostCycles * cycle_) {
        interval_ = std::clamp<std::chrono::nanoseconds>(since_last, cycle_, kLongestInterval);
        return arrival;
    }
    interval_ = std::max(least_step_, interval_ + off / kIntervalShare);
    return expected + off / kTimeShare;
}

}  // namespace metier::robot_skills
