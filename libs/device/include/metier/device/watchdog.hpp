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

/// Stops devices by itself while the thread that commands them does not work.
///
/// The watched thread shows that it works by tick(). If the next tick is later than the limit, the
/// devices are told to stop, and again until it comes. Once the watched thread works again it is
/// told for how long it did not; also when the whole process was stopped, and this with it.
/// Before the first tick nothing is watched, however long a start takes.
///
/// A process of an ordinary operating system cannot promise its own reactions: this is no safety
/// function.
class Watchdog {
public:
    /// What it calls; none may wait for the watched thread, and all must stay valid for its life.
    struct Actions {
        /// Stops every device. The watchdog's thread and the watched one; does nothing to what
        /// stands.
        std::function<void()> stop;
        /// Runs work on the watched thread, before what is posted after it. The watchdog's thread.
        std::function<void(std::function<void()>)> post;
        /// The watched thread did not work for so long; the devices were told to stop. The watched
        /// thread, once for each stall. May come when the watchdog is gone.
        std::function<void(std::chrono::nanoseconds stalled)> tell;
        /// A stall was noticed and the devices were told to stop. The watchdog's thread, or the
        /// watched one if the process was stopped; once for each stall, before tell().
        std::function<void(std::chrono::nanoseconds silent)> noticed;
    };

    /// How often the watched thread should tick, for a limit.
    static constexpr std::chrono::nanoseconds tickPeriod(std::chrono::nanoseconds limit) {
        return limit / 8;
    }

    /// \param limit longest time from one tick to the next, > 0
    /// \param clock must outlive this
    Watchdog(Actions actions, std::chrono::nanoseconds limit, const Clock& clock);
    ~Watchdog() { end(); }
    Watchdog(const Watchdog&) = delete;
    Watchdog& operator=(const Watchdog&) = delete;

    /// The watched thread works. That thread alone; nothing happens after end().
    void tick();

    /// Watches no longer: no action begins after it. Not from an action; again without effect.
    void end();

    /// Judges the last tick. The watchdog's own thread calls it by itself, by the machine's clock;
    /// a test that moves its clock by hand may, too.
    /// \return how long it may wait before it looks again, > 0
    std::chrono::nanoseconds look();

private:
    void run(const std::stop_token& stop);

    const Actions actions_;
    const std::chrono::nanoseconds limit_;
    const Clock& clock_;
    std::atomic<SteadyTime::rep> last_tick_{0};      ///< 0: none yet
    std::atomic<SteadyTime::rep> noticed_after_{0};  ///< the tick after which a stall was noticed
    std::mutex mutex_;
    std::condition_variable_any wake_;
    std::jthread thread_;
    const std::stop_token stopping_;  ///< as the thread's, also once it was joined
};

}  // namespace metier::device
