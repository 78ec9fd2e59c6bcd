#pragma once

#include <chrono>
#include <cstdint>
#include <optional>

#include "metier/base/clock.hpp"
#include "metier/base/histogram.hpp"

namespace metier {

/// Mean of the values that were added to a histogram lately, for a reader that asks from time to
/// time, such as a page of metrics.
///
/// Threading: one thread at a time reads. Adding to the histogram is never delayed by it.
///
///     RecentMean mean(arm.jitter, clock, 10s);
///     if (const auto seconds = mean.read()) { show(*seconds); }  // of the last 10 s or more
class RecentMean {
public:
    /// \param times its contents so far do not count; must outlive this
    /// \param clock must outlive this
    /// \param span  shortest time over which a mean is taken, > 0
    RecentMean(const TimeHistogram& times, const Clock& clock, std::chrono::milliseconds span);

    /// Mean [s] of the values added during the last completed span; nothing if none was added. A
    /// span ends at the first read() after its time, so it is as long as the pause between reads if
    /// that is longer.
    std::optional<double> read();

private:
    /// Number of all values and their sum [s] since the histogram was made.
    struct Total {
        std::uint64_t count = 0;
        double sum = 0;
    };
    Total total() const noexcept;

    const TimeHistogram& times_;
    const Clock& clock_;
    const std::chrono::milliseconds span_;
    SteadyTime begin_;  // begin of the current span
    Total at_begin_;
    std::optional<double> mean_;
};

}  // namespace metier
