#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <thread>

namespace metier {

/// How late a thread of this process wakes up because others have the processors: what is measured
/// meanwhile cannot be sharper, and controllers with cycles of 1 to 10 ms suffer from it.
///
/// Threading: any thread.
class WakeUpDelay {
public:
    WakeUpDelay() : thread_([this](const std::stop_token& stop) { measure(stop); }) {}

    /// The longest since the last call; 0 if there is none.
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
