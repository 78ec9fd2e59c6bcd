#pragma once

#include <condition_variable>
#include <mutex>
#include <stop_token>

#include "metier/base/clock.hpp"

namespace metier::client {

/// Wakes one thread that waits for any of several things to happen.
///
/// Threading: notify() on any thread; wait() on one.
class WakeUp {
public:
    void notify() noexcept {
        {
            const std::lock_guard lock(mutex_);
            notified_ = true;
        }
        changed_.notify_all();
    }

    /// Waits until it was notified since the last wait(), for the deadline, or for a stop request.
    void wait(const std::stop_token& stop, SteadyTime deadline) {
        std::unique_lock lock(mutex_);
        changed_.wait_until(lock, stop, deadline, [this] { return notified_; });
        notified_ = false;
    }

private:
    std::mutex mutex_;
    std::condition_variable_any changed_;
    bool notified_ = false;
};

}  // namespace metier::client
