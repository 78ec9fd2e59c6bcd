#pragma once

#include <algorithm>
#include <chrono>

#include "metier/base/clock.hpp"

namespace metier::ur_driver {

/// Prevents set-points in a bunch. After a delay of the link or the computer many packages of the
/// controller come at once; a set-point for each would make the arm jump along its path.
///
/// Threading: one thread.
class SetPointPace {
public:
    /// \param cycle period of the controller, > 0
    explicit SetPointPace(std::chrono::nanoseconds cycle) noexcept
        : cycle_(cycle), pause_(cycle * 9 / 10) {}

    /// Reports whether the motion may go on by a cycle; that cycle then counts as used. Three
    /// cycles may come together, as many as a usual link may be late; further missing cycles stay
    /// missing.
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
