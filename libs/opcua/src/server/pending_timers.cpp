#include "server/pending_timers.hpp"

#include <algorithm>

#include "common/convert.hpp"

namespace metier::opcua {

namespace {

UA_DateTime fromNow(UA_Server* server, std::chrono::nanoseconds delay) {
    using Ticks = std::chrono::duration<UA_DateTime, std::ratio<1, UA_DATETIME_SEC>>;
    UA_EventLoop* loop = UA_Server_getConfig(server)->eventLoop;
    const auto ticks = std::chrono::ceil<Ticks>(std::max(delay, std::chrono::nanoseconds(0)));
    return loop->dateTime_nowMonotonic(loop) + ticks.count();
}

}  // namespace

PendingTimers::~PendingTimers() {
    for (const auto& [key, pending] : pending_) {
        UA_Server_removeCallback(server_, pending->callback);
    }
}

TimerHandle PendingTimers::start(const std::shared_ptr<PendingTimers>& timers,
                                 std::chrono::nanoseconds delay, std::function<void()> work) {
    auto pending = std::make_unique<Pending>();
    pending->owner = timers.get();
    pending->key = ++timers->last_key_;
    pending->work = std::move(work);
    checkAllocated(UA_Server_addTimedCallback(timers->server_, due, pending.get(),
                                              fromNow(timers->server_, delay), &pending->callback));
    const auto key = pending->key;
    timers->pending_.emplace(key, std::move(pending));
    return TimerHandle([weak = std::weak_ptr(timers), key] {
        if (const auto alive = weak.lock()) {
            alive->cancel(key);
        }
    });
}

void PendingTimers::due(UA_Server* /*server*/, void* pending) noexcept {
    const auto& [owner, key, callback, work] = *static_cast<const Pending*>(pending);
    const auto mine = owner->pending_.extract(key);
    mine.mapped()->owner->run_(mine.mapped()->work);
}

void PendingTimers::cancel(std::uint64_t key) noexcept {
    const auto found = pending_.find(key);
    if (found != pending_.end()) {
        UA_Server_removeCallback(server_, found->second->callback);
        pending_.erase(found);
    }
}

}  // namespace metier::opcua
