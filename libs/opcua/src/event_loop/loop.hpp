#pragma once

#include <atomic>

#include "delayed_callbacks.hpp"
#include "event_loop.hpp"
#include "publisher.hpp"
#include "reactor.hpp"
#include "tcp_connection_manager.hpp"
#include "timers.hpp"

namespace metier::opcua {

/// The parts of the event loop and the order they work in.
///
/// One iteration: due timers, what clients left unprocessed, delayed callbacks, then a wait for
/// the next of these or for the network, then handlers that are ready, with publishing in between.
class Loop {
public:
    explicit Loop(EventLoopOptions options);
    ~Loop();
    Loop(const Loop&) = delete;
    Loop& operator=(const Loop&) = delete;

    UA_EventLoop* handle() { return &handle_; }
    std::recursive_mutex& mutex() { return reactor_.mutex(); }
    std::unique_lock<std::recursive_mutex> lock() { return std::unique_lock(reactor_.mutex()); }

    UA_StatusCode start();
    void stop();
    UA_StatusCode run(std::chrono::milliseconds timeout);
    UA_StatusCode release();

    TimerId addTimer(const Timer& timer, SteadyTime first);
    bool modifyTimer(const Timer& changed, SteadyTime next);
    void removeTimer(TimerId id);
    SteadyTime nextTimer() const;
    void addDelayed(UA_DelayedCallback* callback);
    void removeDelayed(UA_DelayedCallback* callback) { delayed_.remove(callback); }

    TcpConnectionManager& tcp() { return tcp_; }

private:
    struct Handle : UA_EventLoop {
        Loop* loop = nullptr;
    };
    friend struct LoopInterface;
    friend class AsioEventLoop;  // its outside

    SteadyTime stamp();
    void setState(UA_EventLoopState state);
    void iterate(std::chrono::milliseconds timeout, std::unique_lock<std::recursive_mutex>& lock);
    void runTimers(SteadyTime now);
    bool runHandlers();
    SteadyTime waitingEnds(SteadyTime now, std::chrono::milliseconds timeout) const;
    void runReady();
    void flush();
    void checkStopped();

    EventLoopOptions options_;
    Handle handle_{};
    UA_KeyValueMap parameters_{};
    Reactor reactor_;
    Timers timers_;
    DelayedCallbacks delayed_;
    Publisher publisher_;
    TcpConnectionManager tcp_;
    bool running_ = false;
    std::uint64_t iterations_ = 0;
    std::atomic<SteadyTime::rep> last_iteration_{0};
};

}  // namespace metier::opcua
