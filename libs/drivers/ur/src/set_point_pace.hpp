#pragma once

#include <algorithm>
#include <chrono>

#include "metier/base/clock.hpp"

namespace metier::ur_driver {

/// Keeps set-points from coming in a bunch. After a link or a computer was late many packages of
/// the controller come at once; a set-point for each would let the arm jump along its path.
///
/// Threading: one thread.
class SetPointPace {
public:
    /// \param cycle of the controller, > 0
    explicit SetPointPace(std::chrono::nanoseconds cycle) noexcept
        : cycle_(cycle), pause_(cycle * 9 / 10) {}

    /// Whether the motion may go on by a cycle; it then counts as gone on. Three cycles may come
    /// together, as many as a usual link may be late; what is missing more stays missing.
    bool due(SteadyTime now) noexcept {
        if (now + kTogether * cycle_ < next_) {
            return false;
        }
        next_ = std::max(next_, now) + pause_;
        return true;
    }

private:
    static constexpr int kTogether = 2;  // before their time

    std::chrono::nanoseconds cycle_;
    // Shorter than the cycle, so that a controller whose clock is quicker never has to wait.
    std::chrono::nanoseconds pause_;
    SteadyTime next_{};
};

}  // namespace metier::ur_driver
