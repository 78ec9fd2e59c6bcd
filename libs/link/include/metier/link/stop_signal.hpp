#pragma once

#include "metier/base/clock.hpp"

namespace metier::link {

/// Makes Ctrl-C (SIGINT), SIGTERM and the end of the terminal (SIGHUP) something to wait for. The
/// signals are blocked in this thread and in every thread that starts after it. A SIGHUP that is
/// ignored, as under nohup, stays ignored.
///
///     const StopSignal stop;  // first in main()
///     const auto server = ...;
///     stop.wait();
///
/// Create it first in a command, before any thread. Threading: one thread.
class StopSignal {
public:
    /// Blocks the signals, for good. Throws std::runtime_error if the system has no descriptor
    /// left.
    StopSignal();
    ~StopSignal();
    StopSignal(const StopSignal&) = delete;
    StopSignal& operator=(const StopSignal&) = delete;

    /// File descriptor that is readable once a signal has come; for poll().
    int descriptor() const noexcept { return descriptor_; }
    /// Waits for a signal; false at the deadline.
    bool waitUntil(SteadyTime deadline) const;
    /// Waits for a signal without a deadline.
    void wait() const { waitUntil(SteadyTime::max()); }
    /// Reports whether a signal has come; does not wait.
    bool came() const { return waitUntil(SteadyTime{}); }

    /// Bounds the time that the program's end may take: the kernel ends the program if it still
    /// runs after `longest`, for example because a disk or a peer hangs. Whole seconds, by SIGALRM;
    /// a later call replaces it.
    static void endWithin(std::chrono::seconds longest) noexcept;
    /// Makes writing to a lost terminal or pipe fail (SIGPIPE is ignored) instead of ending the
    /// program before its devices stand still.
    static void outliveOutput() noexcept;

private:
    int descriptor_;
};

}  // namespace metier::link
