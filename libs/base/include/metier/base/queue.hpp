#pragma once

#include <condition_variable>
#include <cstddef>
#include <deque>
#include <mutex>
#include <optional>
#include <utility>

#include "metier/base/clock.hpp"

namespace metier {

/// A bounded first-in-first-out queue between threads:
///
///     while (auto job = jobs.popUntil(deadline)) { ... }  // consumer
///     if (!jobs.tryPush(std::move(job))) { ... }          // producer: full or closed
///
/// Threading: any number of producers and consumers. Not for a cycle thread: it locks.
/// No call waits but popUntil(), which waits until its deadline at most. No thread may use it when
/// it is destroyed.
template <typename T>
class Queue {
public:
    /// No memory is reserved for it.
    /// \param capacity largest number of elements, > 0
    explicit Queue(std::size_t capacity) : capacity_(capacity) {}

    /// Appends a value; returns false, and drops the value, if the queue is full or closed. Does
    /// not wait.
    /// \return true if the value is in the queue; one consumer that waits for it is woken
    bool tryPush(T value) {
        {
            const std::lock_guard lock(mutex_);
            if (closed_ || values_.size() >= capacity_) {
                return false;
            }
            values_.push_back(std::move(value));
        }
        changed_.notify_one();
        return true;
    }

    /// Takes the oldest element; waits for one until `deadline`. Nothing if none came by then, or
    /// if the queue is closed and empty. A deadline that is over takes what is there.
    /// Elements come in the order in which they were pushed; which of several waiting consumers
    /// gets the next one is not defined.
    std::optional<T> popUntil(SteadyTime deadline) {
        std::unique_lock lock(mutex_);
        changed_.wait_until(lock, deadline, [this] { return closed_ || !values_.empty(); });
        if (values_.empty()) {
            return std::nullopt;
        }
        std::optional<T> value(std::move(values_.front()));
        values_.pop_front();
        return value;
    }

    /// Refuses further elements and wakes every waiting thread. Elements in the queue can still be
    /// taken. Cannot be undone.
    void close() {
        {
            const std::lock_guard lock(mutex_);
            closed_ = true;
        }
        changed_.notify_all();
    }

private:
    // The mutex guards values_ and closed_. It is never held while a consumer works on an element,
    // nor while one is woken.
    const std::size_t capacity_;
    std::mutex mutex_;
    std::condition_variable changed_;
    std::deque<T> values_;
    bool closed_ = false;
};

}  // namespace metier
