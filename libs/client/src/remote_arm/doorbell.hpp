#pragma once

#include <condition_variable>
#include <mutex>
#include <stop_token>

#include "metier/base/clock.hpp"

namespace metier::client {

/// Wakes one thread that waits for any of several things to happen.
///
/// Threading: ring() on any thread; wait() on one.
class Doorbell {
public:
    void ring() noexcept {
        {
            const std::lock_guard lock(mutex_);
            rung_ = true;
        }
        changed_.notify_all();
    }

    /// Until it was rung since the last wait(), the deadline, or a stop request.
    void wait(const std::stop_token& stop, SteadyTime deadline) {
        std::unique_lock lock(mutex_);
        changed_.wait_until(lock, stop, deadline, [this] { return rung_; });
        rung_ = false;
    }

private:
    std::mutex mutex_;
    std::condition_variable_any changed_;
    bool rung_ = false;
};

}  // namespace metier::client
