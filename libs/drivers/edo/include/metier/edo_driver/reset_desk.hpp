#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <mutex>

#include "metier/base/clock.hpp"
#include "metier/base/error.hpp"

namespace metier::edo_driver {

/// Where any thread asks for a reset and the cycle thread answers.
class ResetDesk {
public:
    /// Waits for the end of a reset that begins now or already runs. If one ended a moment ago and
    /// nobody waited for it any more, its end is the answer.
    /// Errors: those of the reset; timeout if it is still under way after `longest`.
    Result<void> ask(std::chrono::nanoseconds longest);

    // ---- for the cycle thread ----
    /// Whether someone asked since the last call. Neither locks nor allocates.
    bool taken() noexcept { return wanted_.load() && wanted_.exchange(false); }
    void answer(Result<void> outcome);

private:
    std::atomic<bool> wanted_{false};
    std::mutex mutex_;
    std::condition_variable answered_;
    bool under_way_ = false;
    int waiting_ = 0;
    std::uint64_t answers_ = 0;
    Result<void> outcome_;
    SteadyTime unread_until_{};  // what nobody heard is told to who asks next
};

}  // namespace metier::edo_driver
