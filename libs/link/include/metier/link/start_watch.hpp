#pragma once

#include <chrono>
#include <thread>

#include "metier/link/stop_signal.hpp"
#include "metier/link/wake_event.hpp"

namespace metier::link {

/// Ends the program when a stop signal comes during its start, whatever the start is waiting for.
/// No device moves yet, so nothing is lost. A start that checks the signal itself has a moment to
/// end in its own way.
///
/// Threading: one thread creates and destroys it; the start is what happens in between.
///
///     const StartWatch watch(signal);
///     connectToEverything();          // Ctrl-C ends the program here
class StartWatch {
public:
    /// \param signal  must outlive this
    /// \param orderly time that the start has, from the signal on, to end in its own way, >= 0
    explicit StartWatch(const StopSignal& signal,
                        std::chrono::milliseconds orderly = std::chrono::milliseconds(500));
    /// Ends the watch: the start is over.
    ~StartWatch();
    StartWatch(const StartWatch&) = delete;
    StartWatch& operator=(const StartWatch&) = delete;

private:
    /// Ends the process with EXIT_FAILURE, without destructors, if the start goes on for `orderly`
    /// after the signal.
    void watch(const StopSignal& signal, std::chrono::milliseconds orderly);

    WakeEvent over_;
    std::jthread thread_;
};

}  // namespace metier::link
