#pragma once

#include <thread>

#include "metier/link/stop_signal.hpp"
#include "metier/link/wake_event.hpp"

namespace metier::link {

/// Ends the program when it is told to stop while it starts, whatever the start waits for: nothing
/// moves yet, so nothing is lost. A start that looks at the signal itself has half a second to end
/// in its own way.
///
/// Threading: one thread makes and destroys it; the start is what happens between.
class StartWatch {
public:
    /// \param signal must outlive this
    explicit StartWatch(const StopSignal& signal);
    /// The start is over.
    ~StartWatch();
    StartWatch(const StartWatch&) = delete;
    StartWatch& operator=(const StartWatch&) = delete;

private:
    void watch(const StopSignal& signal);

    WakeEvent over_;
    std::jthread thread_;
};

}  // namespace metier::link
