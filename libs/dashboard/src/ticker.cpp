#include "ticker.hpp"

#include <algorithm>
#include <chrono>

namespace metier::dashboard {

Ticker::Ticker(Board& board)
    : board_(board), thread_([this](const std::stop_token& stop) { work(stop); }) {}

void Ticker::run(bool running) {
    {
        const std::lock_guard lock(mutex_);
        running_ = running;
    }
    changed_.notify_all();
}

void Ticker::work(const std::stop_token& stop) {
    constexpr std::chrono::nanoseconds kPeriod =
        std::chrono::nanoseconds(std::chrono::seconds(1)) / 30;
    auto next = std::chrono::steady_clock::now();
    std::unique_lock lock(mutex_);
    while (!stop.stop_requested()) {
        if (!running_) {
            changed_.wait(lock, stop, [this] { return running_; });
            next = std::chrono::steady_clock::now();
            continue;
        }
        lock.unlock();
        board_.tick();
        lock.lock();
        next = std::max(next + kPeriod, std::chrono::steady_clock::now());
        changed_.wait_until(lock, stop, next, [this] { return !running_; });
    }
}

}  // namespace metier::dashboard
