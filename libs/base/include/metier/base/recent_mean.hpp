#pragma once

#include <chrono>
#include <cstdint>
#include <optional>

#include "metier/base/clock.hpp"
#include "metier/base/histogram.hpp"

namespace metier {

/// Mean of what was added to a histogram lately, for whoever looks now and then.
///
/// Threading: one thread at a time reads; whoever adds to the histogram never notices.
class RecentMean {
public:
    /// \param times, clock must outlive this
    /// \param span  shortest time that a mean is of, > 0
    RecentMean(const TimeHistogram& times, const Clock& clock, std::chrono::milliseconds span);

    /// Mean [s] of what was added in the last span that has passed; nothing if nothing was.
    std::optional<double> read();

private:
    struct Total {
        std::uint64_t count = 0;
        double sum = 0;
    };
    Total total() const noexcept;

    const TimeHistogram& times_;
    const Clock& clock_;
    const std::chrono::milliseconds span_;
    SteadyTime begin_;  // of the span that has not passed yet
    Total at_begin_;
    std::optional<double> mean_;
};

}  // namespace metier
