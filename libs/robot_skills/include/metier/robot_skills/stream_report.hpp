#pragma once

#include <atomic>
#include <cmath>
#include <cstdint>
#include <mutex>
#include <string>
#include <utility>

namespace metier::robot_skills {

/// Timing of a stream's set-points, for its client: of the stream that runs, or else of the last
/// one.
///
/// Threading: figures() and lastRefusal() on any thread. The cycle thread notes lag and dropped
/// set-points, without a lock; the owner's thread notes everything else.
///
///     report->noteLag(0.012);               // cycle thread
///     const auto now = report->figures();   // any other thread, for a Variable or a metric
class StreamReport {
public:
    /// Values at one moment; each is whole, but they may belong to different set-points.
    struct Figures {
        /// Time by which the newest set-point waits longer than PlayOutDelay until the arm gets it
        /// [s]; at least 0.
        double lag = 0.0;
        /// Largest lag since the start [s].
        double largest_lag = 0.0;
        /// Largest step of the client's clock against this clock between two set-points [s];
        /// negative: the client's clock stepped back. A network that delays set-points after a
        /// pause can look the same.
        double clock_step = 0.0;
        /// Number of set-points that were refused when written: not finite, out of range, too many.
        std::uint64_t refused = 0;
        /// Number of set-points that were dropped, since their time was not after that of the one
        /// before.
        std::uint64_t dropped = 0;
    };

    /// Present figures; neither locks nor waits.
    Figures figures() const noexcept {
        return {lag_.load(), largest_lag_.load(), clock_step_.load(), refused_.load(),
                dropped_.load()};
    }
    /// Reason of the last refusal of a set-point; empty: none was refused. Locks.
    std::string lastRefusal() const {
        const std::lock_guard lock(mutex_);
        return last_refusal_;
    }

    /// Resets the figures, as a stream starts. Owner's thread, while no arm has the stream.
    void restart() {
        lag_.store(0.0);
        largest_lag_.store(0.0);
        clock_step_.store(0.0);
        refused_.store(0);
        dropped_.store(0);
        const std::lock_guard lock(mutex_);
        last_refusal_.clear();
    }
    /// Keeps the step [s] if it is the largest so far. Owner's thread.
    /// \param step [s], by its absolute value
    void noteClockStep(double step) noexcept {
        if (std::abs(step) > std::abs(clock_step_.load())) {
            clock_step_.store(step);
        }
    }
    /// Counts a refusal and keeps its reason. Locks.
    /// Owner's thread.
    /// \param why text for the client, with value, limit and unit
    void noteRefused(std::string why) {
        ++refused_;
        const std::lock_guard lock(mutex_);
        last_refusal_ = std::move(why);
    }
    /// Shows the lag of the newest set-point [s]. Cycle thread.
    /// \param lag [s], >= 0
    void noteLag(double lag) noexcept {
        lag_.store(lag);
        if (lag > largest_lag_.load()) {
            largest_lag_.store(lag);
        }
    }
    /// Counts a dropped set-point. Cycle thread.
    void noteDropped() noexcept { ++dropped_; }

private:
    // lag_, largest_lag_ and dropped_ have one writer at a time, the cycle thread or restart(); so
    // a load and a store suffice where a larger value is kept.
    std::atomic<double> lag_{0.0};
    std::atomic<double> largest_lag_{0.0};
    std::atomic<double> clock_step_{0.0};
    std::atomic<std::uint64_t> refused_{0};
    std::atomic<std::uint64_t> dropped_{0};
    mutable std::mutex mutex_;
    // Guarded by mutex_; a cycle thread never touches it.
    std::string last_refusal_;
};

}  // namespace metier::robot_skills
