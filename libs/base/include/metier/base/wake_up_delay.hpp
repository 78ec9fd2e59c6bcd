#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <thread>

namespace metier {

/// Measures how late a thread of this process wakes up because other threads have the processors.
/// Times that are measured meanwhile cannot be more precise than this delay, and controllers with
/// cycles of 1 to 10 ms miss their time by it.
///
/// Measures every 5 ms on a thread of its own. Threading: takeLongest() from any thread; it does
/// not wait.
/// Its destructor ends the thread and does not wait for the period to end.
///
///     WakeUpDelay delay;
///     ...                                            // whatever is measured
///     const auto uncertain = delay.takeLongest();    // the measurement is no more precise
class WakeUpDelay {
public:
    /// Begins to measure.
    WakeUpDelay() : thread_([this](const std::stop_token& stop) { measure(stop); }) {}

    /// Longest delay since the last call, from all callers together; 0 if none was measured.
    /// Never negative. The value is taken: a second call at once gives 0 if nothing was measured
    /// between.
    std::chrono::nanoseconds takeLongest() { return longest_.exchange({}); }

private:
    /// Body of the measuring thread: sleeps for a period, compares the wake-up with the time that
    /// was due, keeps the larger value. A stop request ends the sleep at once.
    void measure(const std::stop_token& stop) {
        constexpr std::chrono::milliseconds kPeriod{5};
        std::mutex mutex;
        std::condition_variable_any nobody;
        std::unique_lock lock(mutex);
        while (!stop.stop_requested()) {
            const auto due = std::chrono::steady_clock::now() + kPeriod;
            nobody.wait_until(lock, stop, due, [] { return false; });
            const std::chrono::nanoseconds late = std::chrono::steady_clock::now() - due;
            auto known = longest_.load();
            while (late > known && !longest_.compare_exchange_weak(known, late)) {
            }
        }
    }

    std::atomic<std::chrono::nanoseconds> longest_{};
    std::jthread thread_;  // last: it uses everything above
};

}  // namespace metier
