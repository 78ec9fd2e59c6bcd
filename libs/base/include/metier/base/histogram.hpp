#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>

namespace metier {

/// Histogram of durations [s] with fixed buckets: up to 10 us, 20 us, 50 us, ... 100 s, and longer.
///
/// Threading: any threads, at the same time. No call waits, locks or allocates, so a cycle thread
/// may add. read() sees every value that was added before it, and maybe some of those that are
/// added while it runs: counts and sum may then differ by those.
///
///     TimeHistogram jitter;
///     jitter.add(85e-6);                  // cycle thread; falls into the bucket up to 100 us
///     const auto now = jitter.read();     // any other thread
class TimeHistogram {
public:
    /// Largest value of each bucket [s]; it belongs to the bucket. The last bucket has no bound.
    static constexpr std::array<double, 22> kBounds{
        10e-6, 20e-6, 50e-6, 100e-6, 200e-6, 500e-6, 1e-3, 2e-3, 5e-3, 10e-3, 20e-3,
        50e-3, 0.1,   0.2,   0.5,    1.0,    2.0,    5.0,  10.0, 20.0, 50.0,  100.0};
    /// Number of buckets, with the one for longer durations.
    static constexpr std::size_t kBuckets = kBounds.size() + 1;

    /// Adds one duration. One that is not a number goes to the first bucket and spoils the sum.
    /// \param seconds >= 0 [s]
    void add(double seconds) noexcept {
        std::size_t bucket = 0;
        while (bucket < kBounds.size() && seconds > kBounds[bucket]) {
            ++bucket;
        }
        counts_[bucket].fetch_add(1, std::memory_order_relaxed);
        sum_.fetch_add(seconds, std::memory_order_relaxed);
    }

    /// Contents at one moment. The mean is `sum` divided by the sum of `counts`.
    struct Snapshot {
        /// Number of values in each bucket of kBounds, not cumulated; the last one counts the
        /// longer ones.
        std::array<std::uint64_t, kBuckets> counts{};
        /// Sum of all values [s].
        double sum = 0;
    };
    /// Copies the present contents. Any thread; neither waits nor allocates.
    Snapshot read() const noexcept {
        Snapshot snapshot;
        for (std::size_t i = 0; i < kBuckets; ++i) {
            snapshot.counts[i] = counts_[i].load(std::memory_order_relaxed);
        }
        snapshot.sum = sum_.load(std::memory_order_relaxed);
        return snapshot;
    }

private:
    // Relaxed order is enough: each number stands alone, and no other memory is published by them.
    // Both since the histogram was made.
    std::array<std::atomic<std::uint64_t>, kBuckets> counts_{};
    std::atomic<double> sum_{0};
};

}  // namespace metier
