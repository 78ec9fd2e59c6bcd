#pragma once

#include <atomic>
#include <chrono>

namespace metier {

/// Moment on the monotonic clock: for durations and deadlines within this machine.
using SteadyTime = std::chrono::steady_clock::time_point;
/// Moment on the wall clock: for time stamps that people and other machines read.
using UtcTime = std::chrono::system_clock::time_point;

/// Source of the time, so that tests can use one that they move by hand.
///
/// Threading: any thread; neither waits nor allocates.
class Clock {
public:
    virtual ~Clock() = default;
    /// Monotonic time, for every duration and deadline. Never jumps.
    virtual SteadyTime now() const noexcept = 0;
    /// Wall clock, for time stamps only. May jump when somebody sets the clock.
    virtual UtcTime utcNow() const noexcept = 0;
};

/// The machine's own clocks: steady_clock and system_clock.
///
/// Threading: as Clock; a value without state, so that each user may have one of its own.
class SystemClock final : public Clock {
public:
    SteadyTime now() const noexcept override { return std::chrono::steady_clock::now(); }
    UtcTime utcNow() const noexcept override { return std::chrono::system_clock::now(); }
};

/// A clock that stands until it is moved; both its times move together. It begins at SteadyTime{}
/// and 2026-01-01T00:00:00Z.
///
/// Threading: any thread; advance() does not wake threads that wait for a time.
///
///     ManualClock clock;
///     RecentMean mean(times, clock, 10s);  // code under test keeps a `const Clock&`
///     clock.advance(10s);                  // a test of ten seconds that takes none
class ManualClock final : public Clock {
public:
    SteadyTime now() const noexcept override;
    UtcTime utcNow() const noexcept override;
    /// Moves both times forward.
    /// \param step >= 0, since the monotonic time must not go back; not checked
    void advance(std::chrono::nanoseconds step) noexcept;

private:
    // Sum of all steps [ns]; both times are derived from it, so they cannot differ.
    std::atomic<std::chrono::nanoseconds::rep> elapsed_ns_{0};
};

}  // namespace metier
