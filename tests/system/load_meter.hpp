#pragma once

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <thread>

namespace metier::system_tests {

/// How late a thread of this machine wakes up at the moment: what is measured while it is busy with
/// other things cannot be sharper.
class LoadMeter {
public:
    LoadMeter() : thread_([this](const std::stop_token& stop) { measure(stop); }) {}

    /// The latest since the last call.
    std::chrono::nanoseconds worst() { return worst_.exchange({}); }

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
            worst_ = std::max(worst_.load(), late);
        }
    }

    std::atomic<std::chrono::nanoseconds> worst_{};
    std::jthread thread_;  // last: it uses everything above
};

}  // namespace metier::system_tests
