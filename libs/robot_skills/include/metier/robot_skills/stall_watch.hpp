#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "metier/base/clock.hpp"
#include "metier/device/watchdog.hpp"
#include "metier/skill/executor.hpp"
#include "metier/skill/program.hpp"

namespace metier::robot_skills {

/// Stops the devices of a server when its thread hangs: a watchdog's own thread calls `stop`.
/// Programs that ran are Halted then; their text names the stall and its length.
///
/// Threading: create it on the owner's thread before anything is started; any thread may destroy
/// it, before the owner's thread ends.
class StallWatch {
public:
    /// Settings and actions of a watch.
    struct Setup {
        /// Name of the server, for messages.
        std::string name;
        /// Longest time without a sign of life of the owner's thread, > 0.
        std::chrono::nanoseconds limit;
        /// Stops every device at once, as Arm::stop(). Called on any thread; must stay valid for
        /// the life of the watch. Empty: the server has no device, only skills that run others.
        /// Only the server's thread can ask these to halt, so they are halted when it is back.
        std::function<void()> stop;
        /// Logs one line. Called on any thread; must not wait for the owner's thread.
        std::function<void(const std::string&)> log;
    };

    /// \param executor of the owner's thread; shared with the work that is posted there
    /// \param programs must outlive the owner's thread
    /// \param clock    must outlive this
    StallWatch(Setup setup, std::shared_ptr<skill::Executor> executor,
               std::vector<skill::Program*> programs, const Clock& clock);
    /// Ends the watch; waits for a `stop` or `log` that is running.
    ~StallWatch();
    StallWatch(const StallWatch&) = delete;
    StallWatch& operator=(const StallWatch&) = delete;

private:
    class Pulse;

    // Shared with the timer on the owner's thread, where it ends.
    std::shared_ptr<Pulse> pulse_;
    std::shared_ptr<skill::Executor> executor_;
};

}  // namespace metier::robot_skills
