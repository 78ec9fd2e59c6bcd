#include "metier/device/reset_slot.hpp"

#include <utility>

namespace metier::device {

namespace {

constexpr auto kKept = std::chrono::seconds(5);

SteadyTime now() {
    return std::chrono::steady_clock::now();
}

}  // namespace

std::optional<Result<void>> ResetSlot::ask() {
    const std::lock_guard lock(mutex_);
    if (!under_way_ && now() < std::exchange(unread_until_, {})) {
        return outcome_;
    }
    if (!under_way_) {
        under_way_ = true;
        wanted_.store(true);
    }
    return std::nullopt;
}

bool ResetSlot::underWay() const {
    const std::lock_guard lock(mutex_);
    return under_way_;
}

void ResetSlot::answer(Result<void> outcome) {
    const std::lock_guard lock(mutex_);
    if (!under_way_) {
        return;
    }
    wanted_.store(false);
    under_way_ = false;
    outcome_ = std::move(outcome);
    // A success shows in the safety state, and must not be taken for the end of a later fault.
    unread_until_ = outcome_ ? SteadyTime{} : now() + kKept;
}

}  // namespace metier::device
