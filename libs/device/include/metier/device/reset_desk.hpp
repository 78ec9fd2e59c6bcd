#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <optional>

#include "metier/base/clock.hpp"
#include "metier/base/error.hpp"

namespace metier::device {

/// Longest that resetFault() of a driver waits: it is called on the thread of a server.
inline constexpr std::chrono::milliseconds kResetWait{40};

/// Where any thread asks a driver's own thread for a reset.
class ResetDesk {
public:
    /// Waits for the end of a reset that begins now or already runs. If one failed a moment ago and
    /// nobody waited for it any more, that failure is the answer.
    /// \return nothing if it is still under way after `longest`
    std::optional<Result<void>> ask(std::chrono::nanoseconds longest = kResetWait);
    /// Whether a reset that somebody asked for has not ended.
    bool underWay() const;

    // ---- for the thread that resets ----
    /// Whether someone asked since the last call. Neither locks nor allocates.
    bool taken() noexcept { return wanted_.load() && wanted_.exchange(false); }
    /// The end of what was asked; nothing happens if nobody asked.
    void answer(Result<void> outcome);

private:
    std::atomic<bool> wanted_{false};
    mutable std::mutex mutex_;
    std::condition_variable answered_;
    bool under_way_ = false;
    int waiting_ = 0;
    std::uint64_t answers_ = 0;
    Result<void> outcome_;
    SteadyTime unread_until_{};  // a failure that nobody heard is told to who asks next
};

}  // namespace metier::device
