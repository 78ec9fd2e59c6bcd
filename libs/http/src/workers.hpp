#pragma once

#include "metier/http/httplib.hpp"

#include <condition_variable>
#include <cstddef>
#include <deque>
#include <functional>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

namespace metier::http {

/// A thread for each connection, up to a limit; beyond it the thread that calls enqueue() does the
/// work itself.
///
/// Threading: enqueue() and shutdown() on the one thread that accepts connections.
class Workers final : public httplib::TaskQueue {
public:
    explicit Workers(std::size_t most) : most_(most) {}
    ~Workers() override = default;
    Workers(const Workers&) = delete;
    Workers& operator=(const Workers&) = delete;

    // httplib 0.11 wants nothing back, later versions whether it was taken.
    using Enqueued = decltype(std::declval<httplib::TaskQueue&>().enqueue(std::function<void()>()));

    Enqueued enqueue(std::function<void()> work) override {
        if (!take(work)) {
            work();
        }
        return static_cast<Enqueued>(true);
    }

    void shutdown() override {
        {
            const std::lock_guard lock(mutex_);
            ending_ = true;
        }
        changed_.notify_all();
        threads_.clear();
    }

private:
    bool take(std::function<void()>& work) {
        {
            const std::lock_guard lock(mutex_);
            if (idle_ <= waiting_.size()) {
                if (threads_.size() >= most_) {
                    return false;
                }
                threads_.emplace_back([this] { run(); });
                ++idle_;
            }
            waiting_.push_back(std::move(work));
        }
        changed_.notify_one();
        return true;
    }

    void run() {
        std::unique_lock lock(mutex_);
        for (;;) {
            changed_.wait(lock, [this] { return ending_ || !waiting_.empty(); });
            if (waiting_.empty()) {
                return;
            }
            auto work = std::move(waiting_.front());
            waiting_.pop_front();
            --idle_;
            lock.unlock();
            work();
            work = nullptr;
            lock.lock();
            ++idle_;
        }
    }

    const std::size_t most_;
    std::mutex mutex_;
    std::condition_variable changed_;
    std::deque<std::function<void()>> waiting_;
    std::size_t idle_ = 0;  // threads that wait for work, or are about to
    bool ending_ = false;
    std::vector<std::jthread> threads_;
};

}  // namespace metier::http
