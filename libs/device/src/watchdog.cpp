#include "metier/device/watchdog.hpp"

#include <algorithm>
#include <utility>

namespace metier::device {

using std::chrono::nanoseconds;

Watchdog::Watchdog(Actions actions, nanoseconds limit, const Clock& clock)
    : actions_(std::move(actions)),
      limit_(limit),
      clock_(clock),
      thread_([this](const std::stop_token& stop) { run(stop); }),
      stopping_(thread_.get_stop_token()) {}

void Watchdog::end() {
    thread_.request_stop();
    if (thread_.joinable()) {
        thread_.join();
    }
}

void Watchdog::tick() {
    if (stopping_.stop_requested()) {
        return;
    }
    const auto now = clock_.now().time_since_epoch().count();
    const auto previous = last_tick_.exchange(now);
    const nanoseconds silent(now - previous);
    if (previous == 0 || silent <= limit_ || noticed_after_.exchange(previous) == previous) {
        return;
    }
    actions_.stop();
    actions_.noticed(silent);
    actions_.tell(silent);
}

nanoseconds Watchdog::look() {
    // Before the tick: this thread may be held up here while the watched one ticks.
    const auto now = clock_.now().time_since_epoch().count();
    const auto last = last_tick_.load();
    if (last == 0) {
        return limit_;
    }
    const nanoseconds silent(now - last);
    if (silent <= limit_) {
        return limit_ - silent + std::chrono::microseconds(1);
    }
    actions_.stop();
    if (noticed_after_.exchange(last) != last) {
        actions_.noticed(silent);
        actions_.post([tell = actions_.tell, last, &clock = clock_] {
            tell(nanoseconds(clock.now().time_since_epoch().count() - last));
        });
    }
    return tickPeriod(limit_);
}

void Watchdog::run(const std::stop_token& stop) {
    while (!stop.stop_requested()) {
        const auto pause = look();
        std::unique_lock lock(mutex_);
        wake_.wait_for(lock, stop, pause, [] { return false; });
    }
}

}  // namespace metier::device
