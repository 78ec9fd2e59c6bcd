#pragma once

#include <atomic>
#include <cstdint>
#include <mutex>
#include <optional>

#include "metier/base/clock.hpp"
#include "metier/base/error.hpp"

namespace metier::device {

/// A reset of a device on its way from any thread to the driver's own thread, and its outcome on
/// the way back. One reset at a time; callers do not wait for it but ask again.
///
/// Threading: ask() and underWay() from any thread; taken() and answer() from the driver's own
/// thread, which does the reset.
class ResetSlot {
public:
    /// Requests a reset, unless one is under way. If a reset failed within the last 5 s and nobody
    /// has asked since, no reset begins and that failure is returned; a success shows in the safety
    /// state. Locks, does not wait.
    /// \return nothing while a reset is under way, which began with this call or before: ask again
    /// later
    ///
    ///     if (const auto outcome = slot.ask()) { return *outcome; }
    ///     return fail(Errc::timeout, "the reset goes on: ask again");
    std::optional<Result<void>> ask();
    /// Reports whether a requested reset has not ended yet. Locks.
    bool underWay() const;

    // ---- for the thread that resets ----
    /// Takes a request: true if one came since the last call. Neither locks nor allocates.
    bool taken() noexcept { return wanted_.load() && wanted_.exchange(false); }
    /// Reports the end of a requested reset, also of one that was not taken yet; does nothing if
    /// none was requested. Locks.
    void answer(Result<void> outcome);

private:
    // wanted_ is for the resetting thread, under_way_ for the callers: it stays until answer().
    std::atomic<bool> wanted_{false};
    mutable std::mutex mutex_;
    bool under_way_ = false;
    Result<void> outcome_;
    SteadyTime unread_until_{};  // until then a failure is the answer to the next ask()
};

}  // namespace metier::device
