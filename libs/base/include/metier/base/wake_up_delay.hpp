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
class WakeUpDelay {
public:
    /// Begins to measure.
    WakeUpDelay() : thread_([this](const std::stop_token& stop) { measure(stop); }) {}

    /// Longest delay since the last call, from all callers together; 0 if none was measured.
    std::chrono::nanoseconds takeLongest() { return longest_.exchange({}); }

private:
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
