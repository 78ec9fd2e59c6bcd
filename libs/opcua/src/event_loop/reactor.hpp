#pragma once

#include <asio/io_context.hpp>
#include <asio/steady_timer.hpp>
#include <mutex>
#include <utility>

#include "metier/base/clock.hpp"

namespace metier::opcua {

/// Asio's side of the loop: the waiting, and the mutex that the stack's interface demands.
///
/// The mutex is recursive because open62541 takes it again from callbacks that run under it. It is
/// free only while the loop waits, so a call of the stack from another thread finds the loop
/// between two handlers. The owner thread takes it uncontended.
class Reactor {
public:
    Reactor() : wake_(io_), work_(asio::make_work_guard(io_)) {}

    asio::io_context& io() { return io_; }
    std::recursive_mutex& mutex() { return mutex_; }

    /// Wraps a completion handler: it runs under the mutex and ends the wait.
    template <typename Work>
    auto guarded(Work work) {
        return [this, work = std::move(work)](auto&&... arguments) mutable {
            const std::scoped_lock lock(mutex_);
            waiting_ = false;
            work(std::forward<decltype(arguments)>(arguments)...);
        };
    }

    /// Waits until a handler ran or the time has come; `lock` is released meanwhile.
    void waitUntil(SteadyTime until, std::unique_lock<std::recursive_mutex>& lock);
    /// Runs one handler that is ready, without waiting. \return whether there was one
    bool runReady() { return io_.poll_one() != 0; }
    /// Ends the wait of another thread, if there is one. Under the mutex.
    void wake();

private:
    void arm(SteadyTime until);

    asio::io_context io_;
    asio::steady_timer wake_;
    asio::executor_work_guard<asio::io_context::executor_type> work_;
    SteadyTime armed_for_ = SteadyTime::max();
    std::recursive_mutex mutex_;
    bool waiting_ = false;
};

}  // namespace metier::opcua
