#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <stop_token>
#include <thread>

#include "metier/base/clock.hpp"

namespace metier::device {

/// Stops devices while the thread that commands them does not work.
///
/// The watched thread calls tick() to show that it works, every tickPeriod(). If the next tick is
/// later than the limit, the watchdog stops the devices, again and again until a tick comes. Once
/// the watched thread works again, `tell` gets the length of the stall; also when the whole
/// process, with the watchdog in it, was stopped. Nothing is watched before the first tick, however
/// long a start takes.
///
/// A process of an ordinary operating system cannot promise its own reactions: this is no safety
/// function. robot_skills::StallWatch ticks it from a server's thread.
///
/// Threading: tick() from the watched thread alone; end() and the destructor wait for the
/// watchdog's own thread, so no action may call them.
class Watchdog {
public:
    /// Functions that the watchdog calls. None may wait for the watched thread; all must stay valid
    /// as long as the watchdog lives.
    struct Actions {
        /// Stops every device; must do nothing to one that stands still. Runs on the watchdog's
        /// thread and on the watched one.
        std::function<void()> stop;
        /// Posts work to the watched thread, which runs it before anything posted later. Called on
        /// the watchdog's thread.
        std::function<void(std::function<void()>)> post;
        /// Reports that the watched thread did not work for `stalled` and that the devices were
        /// stopped. Runs on the watched thread, once for each stall, possibly after the watchdog's
        /// end.
        std::function<void(std::chrono::nanoseconds stalled)> tell;
        /// Reports that a stall was noticed and the devices were stopped. Runs on the watchdog's
        /// thread, or on the watched one if the process was stopped; once for each stall, before
        /// tell().
        std::function<void(std::chrono::nanoseconds silent)> noticed;
    };

    /// Period with which the watched thread should call tick(), for a limit: an eighth of it.
    static constexpr std::chrono::nanoseconds tickPeriod(std::chrono::nanoseconds limit) {
        return limit / 8;
    }

    /// Starts the thread, which watches from the first tick on.
    /// \param actions all four must be set
    /// \param limit   longest time from one tick to the next, > 0
    /// \param clock   must outlive this and the closures that Actions::post has got
    Watchdog(Actions actions, std::chrono::nanoseconds limit, const Clock& clock);
    /// Ends the watch and waits for an action that runs.
    ~Watchdog() { end(); }
    Watchdog(const Watchdog&) = delete;
    Watchdog& operator=(const Watchdog&) = delete;

    /// Shows that the watched thread works; only that thread may call it. If the stall was not
    /// noticed by the watchdog's thread, its actions are called here. Does nothing after end().
    void tick();

    /// Ends the watch: no action begins after it. Must not be called from an action; a second call
    /// has no effect.
    void end();

    /// Checks the age of the last tick and acts on it. The watchdog's own thread calls it; a test
    /// that moves its clock by hand may call it, too.
    /// \return time until the next check, > 0
    std::chrono::nanoseconds look();

private:
    void run(const std::stop_token& stop);

    const Actions actions_;
    const std::chrono::nanoseconds limit_;
    const Clock& clock_;
    std::atomic<SteadyTime::rep> last_tick_{0};      ///< 0: none yet
    std::atomic<SteadyTime::rep> noticed_after_{0};  ///< last tick before the stall that was
                                                     ///< noticed
    std::mutex mutex_;
    std::condition_variable_any wake_;
    std::jthread thread_;
    const std::stop_token stopping_;  ///< the thread's token; usable also after the join
};

}  // namespace metier::device
