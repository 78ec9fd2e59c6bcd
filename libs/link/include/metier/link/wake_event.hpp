#pragma once

#include "metier/link/stop_signal.hpp"

namespace metier::link {

/// Event by which any thread ends the wait of another one. A ring() before the wait is not lost;
/// several of them count as one. Each wait takes what was rung before.
///
/// Threading: ring() on any thread; wait() and waitUntil() on one.
class WakeEvent {
public:
    /// Throws std::runtime_error if the system has no descriptor left.
    WakeEvent();
    ~WakeEvent();
    WakeEvent(const WakeEvent&) = delete;
    WakeEvent& operator=(const WakeEvent&) = delete;

    /// Ends the present wait, or the next one. Neither waits nor locks.
    void ring() noexcept;
    /// Waits until ring() was called, or the user ends the program; without a deadline.
    /// \return whether it was rung
    bool wait(const StopSignal& signal);
    /// Waits until ring() was called; false at the deadline.
    /// A stop signal does not end this wait.
    bool waitUntil(SteadyTime deadline);

private:
    /// \return whether ring() was called since the last wait ended
    bool take() noexcept;

    int descriptor_;
};

}  // namespace metier::link
