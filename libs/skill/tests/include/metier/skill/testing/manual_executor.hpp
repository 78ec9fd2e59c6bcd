#pragma once

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <utility>

#include "metier/base/clock.hpp"
#include "metier/skill/executor.hpp"

namespace metier::skill::testing {

/// An Executor whose owner's thread is the test's, and whose time stands until it is moved.
///
/// Threading: post() from any thread, all else from the test's.
class ManualExecutor final : public Executor {
public:
    const ManualClock& clock() const noexcept { return clock_; }

    void post(std::function<void()> work) override {
        {
            const std::lock_guard lock(mutex_);
            posted_.push_back(std::move(work));
            ++post_count_;
        }
        changed_.notify_one();
    }
    /// Number of posts so far.
    std::size_t posts() {
        const std::lock_guard lock(mutex_);
        return post_count_;
    }
    /// Waits, without running anything, until that many posts have come; false after 10 s.
    bool awaitPosts(std::size_t count) {
        std::unique_lock lock(mutex_);
        return changed_.wait_for(lock, std::chrono::seconds(10),
                                 [&] { return post_count_ >= count; });
    }

    Timer after(std::chrono::nanoseconds delay, std::function<void()> work) override {
        const auto key = std::pair(clock_.now() + delay, ++timer_count_);
        timers_->emplace(key, std::move(work));
        return Timer([timers = std::weak_ptr(timers_), key] {
            if (const auto alive = timers.lock()) {
                alive->erase(key);
            }
        });
    }

    /// Runs what was posted, also by the work itself.
    void run() {
        while (auto work = takePosted()) {
            work();
        }
    }

    /// Runs what is posted, also by other threads, until `done` or until `limit` has passed in
    /// real time; whether it is done.
    bool runUntil(const std::function<bool()>& done,
                  std::chrono::milliseconds limit = std::chrono::seconds(10)) {
        const auto deadline = std::chrono::steady_clock::now() + limit;
        while (!done()) {
            auto work = awaitPosted(deadline);
            if (!work) {
                return done();
            }
            work();
        }
        return true;
    }

    /// Moves the time; what falls due on the way runs at its time.
    void advance(std::chrono::nanoseconds step) {
        const auto end = clock_.now() + step;
        run();
        while (!timers_->empty() && timers_->begin()->first.first <= end) {
            auto due = timers_->extract(timers_->begin());
            clock_.advance(std::max(due.key().first - clock_.now(), std::chrono::nanoseconds(0)));
            due.mapped()();
            run();
        }
        clock_.advance(end - clock_.now());
    }

    /// Number of pending timers.
    std::size_t timerCount() const noexcept { return timers_->size(); }

private:
    using Timers = std::map<std::pair<SteadyTime, std::uint64_t>, std::function<void()>>;

    /// The next work; nothing if none came before `deadline`.
    std::function<void()> awaitPosted(SteadyTime deadline) {
        {
            std::unique_lock lock(mutex_);
            changed_.wait_until(lock, deadline, [this] { return !posted_.empty(); });
        }
        return takePosted();
    }
    std::function<void()> takePosted() {
        const std::lock_guard lock(mutex_);
        if (posted_.empty()) {
            return nullptr;
        }
        auto work = std::move(posted_.front());
        posted_.pop_front();
        return work;
    }

    ManualClock clock_;
    std::mutex mutex_;
    std::condition_variable changed_;
    std::deque<std::function<void()>> posted_;
    std::size_t post_count_ = 0;
    // Shared with the Timers, which may outlive the executor.
    std::shared_ptr<Timers> timers_ = std::make_shared<Timers>();
    std::uint64_t timer_count_ = 0;
};

}  // namespace metier::skill::testing
