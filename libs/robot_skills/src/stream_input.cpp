#include "metier/robot_skills/stream_input.hpp"

#include <algorithm>
#include <chrono>
#include <utility>

namespace metier::robot_skills {

namespace {

// How much of what an arrival is off its rhythm goes into the set-point's time and the interval.
constexpr int kTimeShare = 32;
constexpr int kIntervalShare = 1024;
// A set-point that is farther off begins another rhythm: a pause, another rate.
constexpr int kLostCycles = 4;
constexpr std::chrono::milliseconds kLongestInterval{50};

}  // namespace

void StreamTimes::restart() noexcept {
    sender_start_.reset();
    arrival_start_.reset();
    interval_ = cycle_;
    last_arrival_ = {};
}

motion::Seconds StreamTimes::next(std::optional<UtcTime> meant_for) noexcept {
    const auto now = clock_.now();
    const bool first = !arrival_start_;
    arrival_start_ = arrival_start_.value_or(now);
    const std::chrono::nanoseconds arrival = now - *arrival_start_;
    if (!meant_for) {
        const auto meant = first || arrivals_ == Arrivals::each ? arrival : inRhythm(arrival);
        last_ = first ? meant : std::max(meant, last_ + least_step_);
        return last_;
    }
    if (!sender_start_) {
        // What came before without a time is not followed at once: no axis can.
        const auto begin = first ? arrival : std::max(arrival, last_ + cycle_);
        sender_start_ = *meant_for - std::chrono::duration_cast<UtcTime::duration>(begin);
    }
    last_ = *meant_for - *sender_start_;
    return last_;
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
