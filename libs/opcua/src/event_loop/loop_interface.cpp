#include "loop_interface.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

namespace metier::opcua {

namespace {

constexpr UA_Double kLongestIntervalMs = 1e12;  // 30 years

// The stack's time is 100 ns ticks of a clock of its own; only differences are carried over.
using Ticks = std::chrono::duration<UA_Int64, std::ratio<1, 10'000'000>>;

SteadyTime toSteady(UA_DateTime monotonic) {
    return std::chrono::steady_clock::now() + Ticks(monotonic - UA_DateTime_nowMonotonic());
}

UA_DateTime toMonotonic(SteadyTime time) {
    const auto ahead = time - std::chrono::steady_clock::now();
    return UA_DateTime_nowMonotonic() + std::chrono::duration_cast<Ticks>(ahead).count();
}

std::optional<std::chrono::nanoseconds> toInterval(UA_Double interval_ms) {
    const std::chrono::nanoseconds interval(
        std::llround(std::clamp(interval_ms, 0.0, kLongestIntervalMs) * 1e6));
    return interval.count() > 0 ? std::optional(interval) : std::nullopt;  // also for NaN
}

SteadyTime firstCycle(const UA_DateTime* base, std::chrono::nanoseconds interval) {
    const auto now = std::chrono::steady_clock::now();
    return base == nullptr ? now + interval : nextCycle(now, toSteady(*base), interval);
}

/// Runs `work` on the handle's loop, under its mutex. It returns nothing or a StatusCode.
template <typename Work>
UA_StatusCode under(Loop& loop, Work work) noexcept {
    return guard(loop.handle()->logger, [&] {
        const auto held = loop.lock();
        return work(loop);
    });
}

UA_StatusCode addCyclic(UA_EventLoop* handle, UA_Callback callback, void* application, void* data,
                        UA_Double interval_ms, UA_DateTime* base, UA_TimerPolicy policy,
                        UA_UInt64* id) noexcept {
    const auto interval = toInterval(interval_ms);
    if (!interval || callback == nullptr) {
        return UA_STATUSCODE_BADINTERNALERROR;
    }
    return under(LoopInterface::of(handle), [&](Loop& loop) {
        const auto added = loop.addTimer({callback, application, data, *interval, policy},
                                         firstCycle(base, *interval));
        if (id != nullptr) {
            *id = added;
        }
    });
}

UA_StatusCode modifyCyclic(UA_EventLoop* handle, UA_UInt64 id, UA_Double interval_ms,
                           UA_DateTime* base, UA_TimerPolicy policy) noexcept {
    const auto interval = toInterval(interval_ms);
    if (!interval) {
        return UA_STATUSCODE_BADINTERNALERROR;
    }
    return under(LoopInterface::of(handle), [&](Loop& loop) {
        const bool found = loop.modifyTimer({.interval = *interval, .policy = policy, .id = id},
                                            firstCycle(base, *interval));
        return found ? UA_STATUSCODE_GOOD : UA_STATUSCODE_BADNOTFOUND;
    });
}

UA_StatusCode addTimed(UA_EventLoop* handle, UA_Callback callback, void* application, void* data,
                       UA_DateTime date, UA_UInt64* id) noexcept {
    if (callback == nullptr) {
        return UA_STATUSCODE_BADINTERNALERROR;
    }
    return under(LoopInterface::of(handle), [&](Loop& loop) {
        const auto added = loop.addTimer({callback, application, data}, toSteady(date));
        if (id != nullptr) {
            *id = added;
        }
    });
}

UA_DateTime nextCyclicTime(UA_EventLoop* handle) noexcept {
    auto next = UA_INT64_MAX;
    under(LoopInterface::of(handle), [&](Loop& loop) {
        if (const auto time = loop.nextTimer(); time != SteadyTime::max()) {
            next = toMonotonic(time);
        }
    });
    return next;
}

void fillLifecycle(UA_EventLoop& handle) {
    handle.start = [](UA_EventLoop* self) noexcept {
        return under(LoopInterface::of(self), [](Loop& loop) { return loop.start(); });
    };
    handle.stop = [](UA_EventLoop* self) noexcept {
        under(LoopInterface::of(self), [](Loop& loop) { loop.stop(); });
    };
    handle.run = [](UA_EventLoop* self, UA_UInt32 timeout_ms) noexcept {
        return LoopInterface::of(self).run(std::chrono::milliseconds(timeout_ms));
    };
    handle.free = [](UA_EventLoop* self) noexcept {
        return under(LoopInterface::of(self), [](Loop& loop) { return loop.release(); });
    };
    handle.lock = [](UA_EventLoop* self) noexcept { LoopInterface::of(self).mutex().lock(); };
    handle.unlock = [](UA_EventLoop* self) noexcept { LoopInterface::of(self).mutex().unlock(); };
}

void fillTime(UA_EventLoop& handle) {
    handle.dateTime_now = [](UA_EventLoop*) noexcept { return UA_DateTime_now(); };
    handle.dateTime_nowMonotonic = [](UA_EventLoop*) noexcept {
        return UA_DateTime_nowMonotonic();
    };
    handle.dateTime_localTimeUtcOffset = [](UA_EventLoop*) noexcept {
        return UA_DateTime_localTimeUtcOffset();
    };
    handle.nextCyclicTime = nextCyclicTime;
    handle.addCyclicCallback = addCyclic;
    handle.modifyCyclicCallback = modifyCyclic;
    handle.addTimedCallback = addTimed;
    handle.removeCyclicCallback = [](UA_EventLoop* self, UA_UInt64 id) noexcept {
        under(LoopInterface::of(self), [&](Loop& loop) { loop.removeTimer(id); });
    };
}

void fillCallbacks(UA_EventLoop& handle) {
    handle.addDelayedCallback = [](UA_EventLoop* self, UA_DelayedCallback* callback) noexcept {
        under(LoopInterface::of(self), [&](Loop& loop) { loop.addDelayed(callback); });
    };
    handle.removeDelayedCallback = [](UA_EventLoop* self, UA_DelayedCallback* callback) noexcept {
        under(LoopInterface::of(self), [&](Loop& loop) { loop.removeDelayed(callback); });
    };
    handle.registerEventSource = [](UA_EventLoop*, UA_EventSource*) noexcept -> UA_StatusCode {
        return UA_STATUSCODE_BADNOTSUPPORTED;  // the stack's own sources reach into its own loop
    };
    handle.deregisterEventSource = [](UA_EventLoop*, UA_EventSource*) noexcept -> UA_StatusCode {
        return UA_STATUSCODE_BADNOTSUPPORTED;
    };
}

void fillEventSource(UA_EventSource& source, UA_EventLoop& handle) {
    source.eventSourceType = UA_EVENTSOURCETYPE_CONNECTIONMANAGER;
    source.eventLoop = &handle;
    source.state = UA_EVENTSOURCESTATE_STOPPED;
    // Started and stopped with the loop, whose memory it shares.
    source.start = [](UA_EventSource*) noexcept -> UA_StatusCode { return UA_STATUSCODE_GOOD; };
    source.stop = [](UA_EventSource*) noexcept {};
    source.free = [](UA_EventSource*) noexcept -> UA_StatusCode { return UA_STATUSCODE_GOOD; };
}

UA_StatusCode open(UA_ConnectionManager* manager, const UA_KeyValueMap* parameters,
                   void* application, void* context,
                   UA_ConnectionManager_connectionCallback callback) noexcept {
    return under(LoopInterface::of(manager), [&](Loop& loop) {
        return loop.tcp().open(parameters, {callback, application, context})
                   ? UA_STATUSCODE_GOOD
                   : UA_STATUSCODE_BADCONNECTIONREJECTED;
    });
}

}  // namespace

void LoopInterface::fill(UA_EventLoop& handle) {
    fillLifecycle(handle);
    fillTime(handle);
    fillCallbacks(handle);
}

void LoopInterface::fill(UA_ConnectionManager& manager, UA_EventLoop& handle) {
    fillEventSource(manager.eventSource, handle);
    manager.protocol = UA_STRING_STATIC("tcp");
    manager.eventSource.name = manager.protocol;
    manager.openConnection = open;
    manager.sendWithConnection = [](UA_ConnectionManager* self, uintptr_t id, const UA_KeyValueMap*,
                                    UA_ByteString* buffer) noexcept {
        return under(of(self), [&](Loop& loop) { return loop.tcp().send(id, buffer); });
    };
    manager.closeConnection = [](UA_ConnectionManager* self, uintptr_t id) noexcept {
        return under(of(self), [&](Loop& loop) { return loop.tcp().close(id); });
    };
    manager.allocNetworkBuffer = [](UA_ConnectionManager*, uintptr_t, UA_ByteString* buffer,
                                    size_t size) noexcept {
        return UA_ByteString_allocBuffer(buffer, size);
    };
    manager.freeNetworkBuffer = [](UA_ConnectionManager*, uintptr_t,
                                   UA_ByteString* buffer) noexcept { UA_ByteString_clear(buffer); };
}

Loop& LoopInterface::of(UA_EventLoop* handle) {
    // NOLINTNEXTLINE(cppcoreguidelines-pro-type-static-cast-downcast): every handle is a Loop's
    return *static_cast<Loop::Handle*>(handle)->loop;
}

Loop& LoopInterface::of(UA_ConnectionManager* manager) {
    return of(manager->eventSource.eventLoop);
}

}  // namespace metier::opcua
