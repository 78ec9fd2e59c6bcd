#pragma once

#include <sched.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <thread>

namespace metier::records {

/// Delay with which a thread of the writer's priority wakes up on this machine now: nothing that it
/// does can be more punctual.
class Lateness {
public:
    /// Largest delay so far.
    std::chrono::nanoseconds worst() const { return worst_; }

private:
    void measure(const std::stop_token& stop) {
        const sched_param no_priority{};
        static_cast<void>(sched_setscheduler(0, SCHED_BATCH, &no_priority));
        std::mutex mutex;
        std::condition_variable_any nobody;
        std::unique_lock lock(mutex);
        while (!stop.stop_requested()) {
            const auto due = std::chrono::steady_clock::now() + std::chrono::milliseconds(5);
            nobody.wait_until(lock, stop, due, [] { return false; });
            const std::chrono::nanoseconds late = std::chrono::steady_clock::now() - due;
            worst_ = std::max(worst_.load(), late);
        }
    }

    std::atomic<std::chrono::nanoseconds> worst_{};
    std::jthread thread_{[this](const std::stop_token& stop) { measure(stop); }};  // last
};

}  // namespace metier::records
