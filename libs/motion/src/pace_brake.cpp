#include "metier/motion/pace_brake.hpp"

#include <algorithm>

namespace metier::motion {

/// Planned time since the brake began: the integral of the pace 1 - 3 x^2 + 2 x^3 [s].
double PaceBrake::planned() const noexcept {
    const double x = std::min(elapsed_ / length_, 1.0);
    return length_ * (x - x * x * x + x * x * x * x / 2);
}

double PaceBrake::advance(double step) noexcept {
    const double before = planned();
    elapsed_ += step;
    return planned() - before;
}

ScalarState PaceBrake::slowed(const ScalarState& planned) const noexcept {
    if (over()) {
        return {planned.position, 0.0, 0.0};
    }
    const double x = elapsed_ / length_;
    const double pace = 1 - x * x * (3 - 2 * x);
    const double change = -6 * x * (1 - x) / length_;
    return {planned.position, planned.velocity * pace,
            planned.acceleration * pace * pace + planned.velocity * change};
}

}  // namespace metier::motion
