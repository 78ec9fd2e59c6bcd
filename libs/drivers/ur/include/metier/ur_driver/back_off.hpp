#pragma once

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <stop_token>

namespace metier::ur_driver {

/// Waits, or returns at once when a stop is requested.
inline void waitFor(const std::stop_token& stop, std::chrono::nanoseconds time) {
    std::mutex mutex;
    std::condition_variable_any never;
    std::unique_lock lock(mutex);
    never.wait_for(lock, stop, time, [] { return false; });
}

/// The pauses between attempts to connect: 0.2 s, doubled up to 2 s.
class BackOff {
public:
    void reset() noexcept { pause_ = kShortest; }
    void wait(const std::stop_token& stop) {
        waitFor(stop, pause_);
        pause_ = std::min(2 * pause_, kLongest);
    }

private:
    static constexpr std::chrono::milliseconds kShortest{200};
    static constexpr std::chrono::milliseconds kLongest{2000};
    std::chrono::milliseconds pause_ = kShortest;
};

}  // namespace metier::ur_driver
