#pragma once

#include <chrono>
#include <stop_token>

namespace metier::link {

/// Waits for `time`; returns early when a stop is requested. Threads: any.
void waitFor(const std::stop_token& stop, std::chrono::nanoseconds time);

/// Pauses between attempts to connect: 0.2 s first, then doubled each time, up to 2 s:
///
///     while (!stop.stop_requested()) {
///         connect() ? pauses.reset() : pauses.wait(stop);
///     }
///
/// Threading: one thread; the stop may be requested by any.
class BackOff {
public:
    /// Length of the first pause, and of the first after reset().
    static constexpr std::chrono::milliseconds kShortest{200};
    /// Length from which pauses do not grow any more.
    static constexpr std::chrono::milliseconds kLongest{2'000};

    /// Call after a success: makes the next pause the shortest again.
    void reset() noexcept { pause_ = kShortest; }
    /// Length of the next pause.
    std::chrono::milliseconds next() const noexcept { return pause_; }
    /// Waits for the pause, or until a stop is requested; doubles the next pause.
    void wait(const std::stop_token& stop);

private:
    std::chrono::milliseconds pause_ = kShortest;
};

}  // namespace metier::link
