#include "metier/device/safety_publisher.hpp"

namespace metier::device {

SafetyPublisher::SafetyPublisher(Safety initial)
    : state_(initial.state), known_(std::move(initial)), told_(known_.state) {}

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
    std::vector<Callback> callbacks;
    Safety now;
    {
        const std::lock_guard lock(mutex_);
        if (known_.state == told_) {
            return;
        }
        now = known_;
        told_ = now.state;
        for (const auto& [id, callback] : callbacks_) {
            callbacks.push_back(callback);
        }
    }
    for (const auto& callback : callbacks) {
        callback(now);
    }
}

Registration SafetyPublisher::onChange(Callback callback) {
    const std::lock_guard lock(mutex_);
    const auto id = next_callback_++;
    callbacks_.emplace_back(id, std::move(callback));
    return Registration([this, id] {
        const std::lock_guard inner(mutex_);
        std::erase_if(callbacks_, [id](const auto& entry) { return entry.first == id; });
    });
}

}  // namespace metier::device
