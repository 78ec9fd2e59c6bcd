#pragma once

#include <chrono>
#include <cstdint>

#include "metier/base/clock.hpp"

namespace metier::joint_simulator {

/// When the cycles of a controller are due.
///
/// Catch-up rule: a cycle that begins late still is the next whole cycle of the time base, and the
/// cycles behind it follow at once until the time base is reached again. So each set-point is one
/// period after the last and a late thread alone breaks no limit. Only when it is more than
/// kLongestCatchUp late is the time base moved to the present; the cycles left out count as missed
/// and the arm's own time stands still meanwhile.
class TimeBase {
public:
    static constexpr std::chrono::milliseconds kLongestCatchUp{100};

    /// \param first when the first cycle is due
    TimeBase(SteadyTime first, std::chrono::nanoseconds period) noexcept
        : next_(first), period_(period) {}

    /// When the next cycle is due.
    SteadyTime next() const noexcept { return next_; }

    /// Begins the next cycle at `now`, which is not before next().
    /// \return when it was due
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

    /// Cycles that were left out or began at least one period late.
    std::uint64_t missed() const noexcept { return missed_; }

private:
    SteadyTime next_;
    std::chrono::nanoseconds period_;
    std::uint64_t missed_ = 0;
};

}  // namespace metier::joint_simulator
