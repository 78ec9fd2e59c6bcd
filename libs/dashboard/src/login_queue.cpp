#include "login_queue.hpp"

#include <algorithm>

namespace metier::dashboard {

LoginQueue::Place::~Place() {
    if (queue_ != nullptr) {
        queue_->end();
    }
}

LoginQueue::Place LoginQueue::await(std::chrono::milliseconds longest) {
    std::unique_lock lock(mutex_);
    const auto own = next_++;
    waiting_.push_back(own);
    const bool came = changed_.wait_for(
        lock, longest, [&] { return asking_ < at_a_time_ && waiting_.front() == own; });
    waiting_.erase(std::find(waiting_.begin(), waiting_.end(), own));
    asking_ += came ? 1 : 0;
    changed_.notify_all();  // another one is first now
    return Place(came ? this : nullptr);
}

void LoginQueue::end() {
    {
        const std::lock_guard lock(mutex_);
        --asking_;
    }
    changed_.notify_all();
}

}  // namespace metier::dashboard
