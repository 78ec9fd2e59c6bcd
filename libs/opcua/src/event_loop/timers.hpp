#pragma once

#include <open62541/plugin/eventloop.h>

#include <chrono>
#include <map>
#include <optional>
#include <set>
#include <unordered_map>
#include <utility>

#include "metier/base/clock.hpp"

namespace metier::opcua {

using TimerId = UA_UInt64;

/// A callback of the stack, and its period.
struct Timer {
    UA_Callback callback = nullptr;
    void* application = nullptr;
    void* data = nullptr;
    std::chrono::nanoseconds interval{0};  ///< 0: once
    UA_TimerPolicy policy = UA_TIMER_HANDLE_CYCLEMISS_WITH_CURRENTTIME;
    TimerId id = 0;
    bool can_wait = false;  ///< works for a peer: others come first
};

/// The stack's cyclic and one-shot timers, each due exactly when it was asked for.
///
/// Nothing is called from here: the owner takes due timers one by one, so a callback may add,
/// change and remove any timer, itself included.
/// Threading: one thread, or under the loop's mutex.
class Timers {
public:
    /// \return the new timer's id, never 0
    TimerId add(Timer timer, SteadyTime first);
    /// Gives a timer another interval, policy and next time. \return whether it exists
    bool modify(const Timer& changed, SteadyTime next);
    void remove(TimerId id);
    void clear();

    /// Takes the earliest timer due at `now` that cannot wait. A cyclic one is scheduled again,
    /// later than `now`; a one-shot is removed.
    std::optional<Timer> takeDue(SteadyTime now) { return take(order_, now); }
    /// The same of those that can.
    std::optional<Timer> takeWaiting(SteadyTime now) { return take(waiting_order_, now); }
    std::optional<SteadyTime> next() const;

private:
    struct Entry {
        Timer timer;
        SteadyTime due;
    };

    using Order = std::set<std::pair<SteadyTime, TimerId>>;
    Order& orderOf(const Timer& timer) { return timer.can_wait ? waiting_order_ : order_; }
    std::optional<Timer> take(Order& order, SteadyTime now);
    void schedule(Entry& entry, SteadyTime due);

    std::unordered_map<TimerId, Entry> entries_;
    Order order_;
    Order waiting_order_;
    TimerId last_id_ = 0;
};

/// The first instant after `now` that is a whole number of intervals from `base`.
SteadyTime nextCycle(SteadyTime now, SteadyTime base, std::chrono::nanoseconds interval);

}  // namespace metier::opcua
