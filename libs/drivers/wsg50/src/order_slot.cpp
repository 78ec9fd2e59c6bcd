#include "order_slot.hpp"

#include <utility>

namespace metier::wsg50_driver {

Result<void> OrderSlot::ask(const Motion& motion, device::Gripper::Done done) {
    const std::lock_guard lock(mutex_);
    if (closed_) {
        return fail(*closed_);
    }
    if (done_) {
        return fail(Errc::resource_unavailable, "the jaws already move");
    }
    asked_ = motion;
    done_ = std::move(done);
    stop_.store(false);
    return {};
}

void OrderSlot::open() {
    const std::lock_guard lock(mutex_);
    closed_.reset();
}

void OrderSlot::close(Error why) {
    const std::lock_guard lock(mutex_);
    closed_ = std::move(why);
}

std::optional<Motion> OrderSlot::takeMotion() {
    const std::lock_guard lock(mutex_);
    return std::exchange(asked_, std::nullopt);
}

bool OrderSlot::occupied() const {
    const std::lock_guard lock(mutex_);
    return done_ && !outcome_;
}

void OrderSlot::endMotion(Result<device::GripperOutcome> outcome) {
    const std::lock_guard lock(mutex_);
    if (done_ && !outcome_) {
        asked_.reset();
        outcome_ = std::move(outcome);
    }
}

void OrderSlot::dispatch() {
    std::unique_lock lock(mutex_);
    if (!outcome_) {
        return;
    }
    auto outcome = std::move(*outcome_);
    outcome_.reset();
    const auto done = std::exchange(done_, nullptr);
    lock.unlock();
    done(std::move(outcome));
}

}  // namespace metier::wsg50_driver
