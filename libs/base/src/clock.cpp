#include "metier/base/clock.hpp"

namespace metier {

SteadyTime ManualClock::now() const noexcept {
    return SteadyTime(std::chrono::nanoseconds(elapsed_ns_.load()));
}

UtcTime ManualClock::utcNow() const noexcept {
    // 2026-01-01T00:00:00Z, so that printed times look like times.
    constexpr UtcTime kStart{std::chrono::seconds(1'767'225'600)};
    return kStart + std::chrono::nanoseconds(elapsed_ns_.load());
}

void ManualClock::advance(std::chrono::nanoseconds step) noexcept {
    elapsed_ns_.fetch_add(step.count());
}

}  // namespace metier
