#include "timers.hpp"

namespace metier::opcua {

SteadyTime nextCycle(SteadyTime now, SteadyTime base, std::chrono::nanoseconds interval) {
    auto into_cycle = (now - base) % interval;
    if (into_cycle < std::chrono::nanoseconds::zero()) {
        into_cycle += interval;
    }
    return now + interval - into_cycle;
}

TimerId Timers::add(Timer timer, SteadyTime first) {
    timer.id = ++last_id_;
    auto& entry = entries_.emplace(timer.id, Entry{timer, first}).first->second;
    schedule(entry, first);
    return timer.id;
}

bool Timers::modify(const Timer& changed, SteadyTime next) {
    const auto found = entries_.find(changed.id);
    if (found == entries_.end()) {
        return false;
    }
    auto& entry = found->second;
    orderOf(entry.timer).erase({entry.due, changed.id});
    entry.timer.interval = changed.interval;
    entry.timer.policy = changed.policy;
    schedule(entry, next);
    return true;
}

void Timers::remove(TimerId id) {
    const auto found = entries_.find(id);
    if (found == entries_.end()) {
        return;
    }
    orderOf(found->second.timer).erase({found->second.due, id});
    entries_.erase(found);
}

void Timers::clear() {
    order_.clear();
    waiting_order_.clear();
    entries_.clear();
}

std::optional<Timer> Timers::take(Order& order, SteadyTime now) {
    if (order.empty() || order.begin()->first > now) {
        return std::nullopt;
    }
    const auto found = entries_.find(order.begin()->second);
    order.erase(order.begin());
    auto& entry = found->second;
    const Timer timer = entry.timer;
    if (timer.interval == std::chrono::nanoseconds::zero()) {
        entries_.erase(found);
        return timer;
    }
    auto due = entry.due + timer.interval;
    if (due <= now) {  // it missed at least one cycle
        due = timer.policy == UA_TIMER_HANDLE_CYCLEMISS_WITH_BASETIME
                  ? nextCycle(now, entry.due, timer.interval)
                  : now + timer.interval;
    }
    schedule(entry, due);
    return timer;
}

std::optional<SteadyTime> Timers::next() const {
    std::optional<SteadyTime> next;
    for (const auto* order : {&order_, &waiting_order_}) {
        if (!order->empty() && (!next || order->begin()->first < *next)) {
            next = order->begin()->first;
        }
    }
    return next;
}

void Timers::schedule(Entry& entry, SteadyTime due) {
    entry.due = due;
    orderOf(entry.timer).emplace(due, entry.timer.id);
}

}  // namespace metier::opcua
