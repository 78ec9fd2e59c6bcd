#pragma once

#include <algorithm>
#include <chrono>

#include "metier/base/clock.hpp"

namespace metier::opcua {

/// Lets `burst` pass at once, and `per_second` for long.
///
/// Threading: one thread.
class RateLimit {
public:
    RateLimit(double burst, double per_second) noexcept
        : burst_(burst), per_second_(per_second), left_(burst) {}

    /// Whether one more may pass. \param now never before that of the last call
    bool take(SteadyTime now) noexcept {
        const std::chrono::duration<double> passed = now - last_;
        left_ = std::min(burst_, left_ + passed.count() * per_second_);
        last_ = now;
        if (left_ < 1.0) {
            return false;
        }
        left_ -= 1.0;
        return true;
    }

private:
    double burst_;
    double per_second_;
    double left_;
    SteadyTime last_{};
};

}  // namespace metier::opcua
