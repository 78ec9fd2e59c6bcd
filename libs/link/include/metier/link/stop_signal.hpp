#pragma once

#include "metier/base/clock.hpp"

namespace metier::link {

/// Ctrl-C, SIGTERM and the end of the terminal (SIGHUP) as something to wait for: blocked in every
/// thread that starts after it. A SIGHUP that is ignored, as below nohup, stays so.
///
/// Make it first thing in a command. Threading: one thread.
class StopSignal {
public:
    StopSignal();
    ~StopSignal();
    StopSignal(const StopSignal&) = delete;
    StopSignal& operator=(const StopSignal&) = delete;

    /// Becomes readable when a signal came; for poll().
    int descriptor() const noexcept { return descriptor_; }
    /// Waits for a signal; false at the deadline.
    bool waitUntil(SteadyTime deadline) const;
    /// Waits for a signal for as long as the user wants.
    void wait() const { waitUntil(SteadyTime::max()); }
    bool came() const { return waitUntil(SteadyTime{}); }

    /// Bounds the end of the program: the kernel ends it when it still runs after that time,
    /// because a disk or a peer hangs.
    static void endWithin(std::chrono::seconds longest) noexcept;
    /// Lets writing to a terminal or a pipe that is gone fail instead of ending the program before
    /// its devices stand.
    static void outliveOutput() noexcept;

private:
    int descriptor_;
};

}  // namespace metier::link
