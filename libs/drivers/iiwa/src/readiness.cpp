#include "readiness.hpp"

#include "controller_planned_run.hpp"

namespace metier::iiwa_driver {

namespace {

// Time for which "ready" must be missing [s]: for a moving arm that was ready while it moved, and
// for an arm at rest, since "ready" may come a little after the end of a motion.
constexpr double kMissingInMotion = 0.03;
constexpr double kMissingAtRest = 0.2;

}  // namespace

void Readiness::take(const CabinetState& answer, double step) noexcept {
    const bool moving = answer.active || !stands(answer);
    if (answer.ready) {
        ready_while_moving_ = ready_while_moving_ || moving;
        missing_ = 0.0;
        not_ready_ = false;
        return;
    }
    missing_ += step;
    if (ready_while_moving_ && moving) {
        not_ready_ = not_ready_ || missing_ >= kMissingInMotion;
    } else if (stands(answer)) {
        not_ready_ = not_ready_ || missing_ >= kMissingAtRest;
    }
}

}  // namespace metier::iiwa_driver
