#include "metier/edo_driver/reset_desk.hpp"

#include <utility>

namespace metier::edo_driver {

Result<void> ResetDesk::ask(std::chrono::nanoseconds longest) {
    std::unique_lock lock(mutex_);
    if (!under_way_) {
        under_way_ = true;
        wanted_.store(true);
    }
    const auto before = answers_;
    if (!answered_.wait_for(lock, longest, [&] { return answers_ != before; })) {
        return fail(Errc::timeout, "the reset is still under way; ask again");
    }
    return outcome_;
}

void ResetDesk::answer(Result<void> outcome) {
    {
        const std::lock_guard lock(mutex_);
        if (!under_way_) {
            return;
        }
        wanted_.store(false);
        under_way_ = false;
        ++answers_;
        outcome_ = std::move(outcome);
    }
    answered_.notify_all();
}

}  // namespace metier::edo_driver
