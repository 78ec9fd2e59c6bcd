#pragma once

#include <chrono>
#include <cstdint>

#include "metier/base/clock.hpp"

namespace metier::joint_simulator {

/// Schedule of a controller's cycles.
///
/// Catch-up rule: a cycle that begins late is still the next cycle of the schedule, and the cycles
/// after it follow at once until the schedule is reached again. So each set-point is one period
/// after the last, and a late thread alone breaks no limit. Only a delay of more than
/// kLongestCatchUp moves the schedule to the present; the cycles left out count as missed, and the
/// arm's own time stands still meanwhile.
///
/// Threading: a value, used by one thread; reads no clock.
///
///     TimeBase base(clock.now() + period, period);
///     ... wait until base.next() ...
///     arm.cycle(base.begin(clock.now()), base.missed());
class TimeBase {
public:
    /// Longest delay that is caught up.
    static constexpr std::chrono::milliseconds kLongestCatchUp{100};

    /// \param first  time at which the first cycle is due
    /// \param period > 0
    TimeBase(SteadyTime first, std::chrono::nanoseconds period) noexcept
        : next_(first), period_(period) {}

    /// Time at which the next cycle is due.
    SteadyTime next() const noexcept { return next_; }

    /// Begins the next cycle at `now`, which is not before next().
    /// A cycle that begins less than one period late counts as in time.
    /// \return time at which it was due
    SteadyTime begin(SteadyTime now) noexcept {
        if (now - next_ > kLongestCatchUp) {
            const auto left_out = (now - next_) / period_;
            next_ += left_out * period_;
            missed_ += static_cast<std::uint64_t>(left_out);
        }
        if (now - next_ >= period_) {
            ++missed_;
        }
        const auto due = next_;
        next_ += period_;
        return due;
    }

    /// Number of cycles that were left out or began at least one period late.
    /// Since the time base was made; never falls.
    std::uint64_t missed() const noexcept { return missed_; }

private:
    SteadyTime next_;
    std::chrono::nanoseconds period_;
    std::uint64_t missed_ = 0;
};

}  // namespace metier::joint_simulator
