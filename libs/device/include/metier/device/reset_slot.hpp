#pragma once

#include <atomic>
#include <cstdint>
#include <mutex>
#include <optional>

#include "metier/base/clock.hpp"
#include "metier/base/error.hpp"

namespace metier::device {

/// Place where any thread asks a driver's own thread for a reset. Nobody waits.
class ResetSlot {
public:
    /// Begins a reset, unless one runs already. If one failed a moment ago and nobody has heard of
    /// it, nothing begins, and that failure is the answer; a success shows in the safety state.
    /// \return nothing while it is under way: ask again
    std::optional<Result<void>> ask();
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
    bool under_way_ = false;
    Result<void> outcome_;
    SteadyTime unread_until_{};  // a failure is the answer to whoever asks next
};

}  // namespace metier::device
