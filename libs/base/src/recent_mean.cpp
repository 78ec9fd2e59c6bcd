#include "metier/base/recent_mean.hpp"

#include <numeric>

namespace metier {

RecentMean::RecentMean(const TimeHistogram& times, const Clock& clock,
                       std::chrono::milliseconds span)
    : times_(times), clock_(clock), span_(span), begin_(clock.now()), at_begin_(total()) {}

RecentMean::Total RecentMean::total() const noexcept {
    const auto read = times_.read();
    return {std::accumulate(read.counts.begin(), read.counts.end(), std::uint64_t{0}), read.sum};
}

std::optional<double> RecentMean::read() {
    const auto now = clock_.now();
    if (now - begin_ < span_) {
        return mean_;
    }
    const auto latest = total();
    const auto added = latest.count - at_begin_.count;
    mean_ = added == 0 ? std::nullopt
                       : std::optional((latest.sum - at_begin_.sum) / static_cast<double>(added));
    begin_ = now;
    at_begin_ = latest;
    return mean_;
}

}  // namespace metier
