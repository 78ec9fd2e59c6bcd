#include "gripper_slot.hpp"

namespace metier::edo_driver {

Result<void> GripperSlot::ask(const GripperTask& task, device::Gripper::Done done) {
    const std::lock_guard lock(mutex_);
    if (busy_.load()) {
        return fail(Errc::resource_unavailable, "another motion of the jaws runs");
    }
    busy_.store(true);
    stop_.store(false);
    task_ = task;
    done_ = std::move(done);
    has_task_.store(true);
    return {};
}

GripperTask GripperSlot::take() {
    const std::lock_guard lock(mutex_);
    has_task_.store(false);
    return task_;
}

void GripperSlot::finish(Outcome outcome) {
    const std::lock_guard lock(mutex_);
    if (!busy_.load()) {
        return;
    }
    to_tell_.emplace_back(std::exchange(done_, nullptr), std::move(outcome));
    has_task_.store(false);
    busy_.store(false);
    ended_.store(true);
}

void GripperSlot::dispatch() {
    std::vector<std::pair<device::Gripper::Done, Outcome>> ended;
    {
        const std::lock_guard lock(mutex_);
        ended.swap(to_tell_);
        ended_.store(false);
    }
    for (auto& [done, outcome] : ended) {
        done(std::move(outcome));
    }
}

}  // namespace metier::edo_driver
