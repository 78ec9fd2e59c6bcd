#include <fmt/format.h>

#include <utility>

#include "motion_check.hpp"
#include "motion_commander.hpp"

// Requests to the commander, from any thread.

namespace metier::iiwa_driver {

using device::SafetyState;

Result<void> MotionCommander::attach(std::shared_ptr<device::SetPointSource> source) {
    const std::lock_guard lock(admission_);
    if (slot_.occupied()) {
        return fail(Errc::resource_unavailable,
                    core_.info().name + ": a motion of the cabinet's planner runs");
    }
    return core_.attach(std::move(source));
}

Result<void> MotionCommander::move(const device::ControllerPlannedMotion& motion,
                                   device::MotionPlanner::Done done) {
    const std::lock_guard lock(admission_);
    const auto safety = core_.safety();
    if (safety.state != SafetyState::normal) {
        const bool lost = safety.state == SafetyState::disconnected;
        return fail(lost ? Errc::connection_lost : Errc::device_fault,
                    fmt::format("{} ({})", safety.text, device::toString(safety.state)));
    }
    METIER_TRY(checkMotion(model_, motion));
    auto ended = [this, done = std::move(done)](const RunEnd& end) {
        done(outcomeOf(end, core_.info().name, lostText()));
    };
    if (core_.active() != nullptr || !slot_.post(motion, std::move(ended))) {
        return fail(Errc::resource_unavailable, core_.info().name + ": another motion runs");
    }
    return {};
}

Result<void> MotionCommander::resetFault() {
    const auto safety = core_.safety();
    if (safety.state == SafetyState::normal) {
        return {};
    }
    if (safety.state == SafetyState::disconnected) {
        return fail(Errc::connection_lost, safety.text);
    }
    if (!latched_.load()) {
        return fail(Errc::device_fault, safety.text);
    }
    if (!core_.state().standstill) {
        return fail(Errc::device_fault, core_.info().name + ": the arm still brakes");
    }
    core_.setSafety({SafetyState::normal, "", false});
    latched_.store(false);  // the cycle decides again from now on
    return {};
}

void MotionCommander::dispatch() {
    core_.dispatch();
    slot_.dispatch();
}

std::string MotionCommander::lostText() {
    const std::lock_guard lock(lost_mutex_);
    return lost_text_;
}

}  // namespace metier::iiwa_driver
