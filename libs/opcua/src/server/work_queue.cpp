#include "server/work_queue.hpp"

#include <utility>

namespace metier::opcua {

WorkQueue::Pushed WorkQueue::push(std::function<void()> work) {
    const std::lock_guard lock(mutex_);
    if (closed_) {
        return Pushed::refused;
    }
    waiting_.push_back(std::move(work));
    return waiting_.size() == 1 ? Pushed::first : Pushed::further;
}

void WorkQueue::drain(const std::function<void(const std::function<void()>&)>& run) {
    for (const auto& work : takeAll()) {
        run(work);
    }
}

std::size_t WorkQueue::size() const {
    const std::lock_guard lock(mutex_);
    return waiting_.size();
}

std::vector<std::function<void()>> WorkQueue::close() {
    {
        const std::lock_guard lock(mutex_);
        closed_ = true;
    }
    return takeAll();
}

std::vector<std::function<void()>> WorkQueue::takeAll() {
    const std::lock_guard lock(mutex_);
    return std::exchange(waiting_, {});
}

}  // namespace metier::opcua
