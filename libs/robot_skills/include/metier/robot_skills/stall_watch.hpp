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

/// Keeps the devices of a server from moving on while its thread does not work: a watchdog's thread
/// stops them. What ran is then Halted; its text names the stall and its length.
///
/// Threading: made on the owner's thread before anything is started; ended by any thread before the
/// owner's ends.
class StallWatch {
public:
    struct Setup {
        std::string name;                ///< of the server, for texts
        std::chrono::nanoseconds limit;  ///< longest time without a sign of the owner's thread, > 0
        /// Stops every device at once, as Arm::stop(); any thread. Stays valid for the watch's
        /// life. Empty: the server has no device, only skills that run others; these are halted
        /// when its thread is back, since only it can ask for that.
        std::function<void()> stop;
        /// Logs one line. Any thread; must not wait for the owner's.
        std::function<void(const std::string&)> log;
    };

    /// \param executor of the owner's thread; shared with what is posted there
    /// \param programs must outlive the owner's thread
    /// \param clock    must outlive this
    StallWatch(Setup setup, std::shared_ptr<skill::Executor> executor,
               std::vector<skill::Program*> programs, const Clock& clock);
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
