#pragma once

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <thread>

namespace metier::app {

/// How late a thread of this machine wakes up because others have the processors.
///
/// Threading: any thread.
class MachineLoad {
public:
    /// More than this is too much for controllers whose cycles take 1 to 10 ms.
    static constexpr std::chrono::milliseconds kTooLate{100};

    MachineLoad() : thread_([this](const std::stop_token& stop) { measure(stop); }) {}

    /// The latest since the last call.
    std::chrono::nanoseconds takeLatest() { return latest_.exchange({}); }

private:
    void measure(const std::stop_token& stop) {
        constexpr std::chrono::milliseconds kPeriod{10};
        std::mutex mutex;
        std::condition_variable_any nobody;
        std::unique_lock lock(mutex);
        while (!stop.stop_requested()) {
            const auto due = std::chrono::steady_clock::now() + kPeriod;
            nobody.wait_until(lock, stop, due, [] { return false; });
            const std::chrono::nanoseconds late = std::chrono::steady_clock::now() - due;
            latest_ = std::max(latest_.load(), late);
        }
    }

    std::atomic<std::chrono::nanoseconds> latest_{};
    std::jthread thread_;  // last: it uses everything above
};

}  // namespace metier::app
