#pragma once

#include "metier/base/clock.hpp"

namespace metier::app {

/// Ctrl-C and SIGTERM as something to wait for: blocked in every thread that starts after it.
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

private:
    int descriptor_;
};

}  // namespace metier::app
