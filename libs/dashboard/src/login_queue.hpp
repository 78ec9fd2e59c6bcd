#pragma once

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <deque>
#include <mutex>

namespace metier::dashboard {

/// Lets so many at a time ask servers whether a password is right; others wait, first come, first
/// served. So a flood of wrong log-ins delays a right one, and does not keep it out.
///
/// Threading: any.
class LoginQueue {
public:
    explicit LoginQueue(std::size_t at_a_time) : at_a_time_(at_a_time) {}

    /// The right to ask, until its end. Must not outlive the queue.
    class Place {
    public:
        explicit Place(LoginQueue* queue) : queue_(queue) {}
        ~Place();
        Place(const Place&) = delete;
        Place& operator=(const Place&) = delete;
        explicit operator bool() const noexcept { return queue_ != nullptr; }

    private:
        LoginQueue* queue_;
    };

    /// Waits for a turn. \return none: it did not come within that time
    Place await(std::chrono::milliseconds longest);

private:
    void end();

    const std::size_t at_a_time_;
    std::mutex mutex_;
    std::condition_variable changed_;
    std::size_t asking_ = 0;
    std::deque<std::size_t> waiting_;  // numbers, in the order in which they came
    std::size_t next_ = 0;
};

}  // namespace metier::dashboard
