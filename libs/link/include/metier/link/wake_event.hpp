#pragma once

#include "metier/link/stop_signal.hpp"

namespace metier::link {

/// Ends the wait of one thread from another.
///
/// Threading: ring() on any thread; wait() on one.
class WakeEvent {
public:
    WakeEvent();
    ~WakeEvent();
    WakeEvent(const WakeEvent&) = delete;
    WakeEvent& operator=(const WakeEvent&) = delete;

    void ring() noexcept;
    /// Until it was rung, since the last time, or the user ends the program.
    /// \return whether it was rung
    bool wait(const StopSignal& signal);
    /// Until it was rung; false at the deadline.
    bool waitUntil(SteadyTime deadline);

private:
    /// \return whether it was rung since the last time
    bool take() noexcept;

    int descriptor_;
};

}  // namespace metier::link
