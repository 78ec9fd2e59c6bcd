#include "metier/device/safety_publisher.hpp"

#include <algorithm>

namespace metier::device {

SafetyPublisher::SafetyPublisher(Safety initial)
    : state_(initial.state), known_(std::move(initial)), reported_(known_.state) {}

Safety SafetyPublisher::safety() const {
    const std::lock_guard lock(mutex_);
    return known_;
}

void SafetyPublisher::set(Safety safety) {
    const std::lock_guard lock(mutex_);
    if (safety.state != known_.state) {
        changed_.store(true);
    }
    state_.store(safety.state);
    known_ = std::move(safety);
}

void SafetyPublisher::dispatch() {
    if (!changed_.exchange(false)) {
        return;
    }
    Safety now;
    {
        const std::lock_guard lock(mutex_);
        if (known_.state == reported_) {
            return;
        }
        now = known_;
        reported_ = now.state;
    }
    std::vector<Callback> callbacks;
    {
        const std::lock_guard lock(listeners_->mutex);
        for (const auto& [id, callback] : listeners_->callbacks) {
            callbacks.push_back(callback);
        }
    }
    for (const auto& callback : callbacks) {
        callback(now);
    }
}

Registration SafetyPublisher::onChange(Callback callback) {
    const std::lock_guard lock(listeners_->mutex);
    const auto id = listeners_->next++;
    listeners_->callbacks.emplace_back(id, std::move(callback));
    return Registration([listeners = std::weak_ptr(listeners_), id] {
        if (const auto alive = listeners.lock()) {
            Callback gone;  // dropped without the lock: it may own another registration here
            const std::lock_guard inner(alive->mutex);
            const auto entry =
                std::ranges::find(alive->callbacks, id, &std::pair<std::uint64_t, Callback>::first);
            if (entry != alive->callbacks.end()) {
                gone = std::move(entry->second);
                alive->callbacks.erase(entry);
            }
        }
    });
}

}  // namespace metier::device
