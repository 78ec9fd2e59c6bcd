#include "controller_planned_run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string_view>
#include <utility>

#include "commands.hpp"
#include "metier/motion/frame.hpp"
#include "metier/motion/rotation.hpp"

namespace metier::iiwa_driver {

using device::ControllerPlannedMotion;
using Cause = RunEnd::Cause;

namespace {

// The arm has reached its target when it is this near.
constexpr double kAxisTolerance = 2e-3;      // [rad]
constexpr double kPositionTolerance = 1e-3;  // [m]
constexpr double kRotationTolerance = 5e-3;  // [rad]
// Initial values of the robot application: docs/protocols/iiwa.md#commands.
constexpr double kOwnLineVelocity = 1.0;      // [m/s]
constexpr double kOwnLineAcceleration = 1.0;  // [m/s2]
// Longest time from the acceptance of a motion to its begin [s].
constexpr double kLongestStart = 0.3;
// Longest time for the arm to settle after the cabinet has ended the motion [s].
constexpr double kLongestSettling = 0.1;
// A motion is given up when no axis got so far [rad] in so long [s]. Its speed says nothing: a slow
// motion is slower than the noise of the cabinet's differences.
constexpr double kLeastProgress = 1e-4;
constexpr double kLongestStall = 3.0;
// Longest time of braking [s], and time after which it is requested again.
constexpr double kLongestBraking = 4.0;
constexpr double kCancelAgain = 0.5;

Miss worstAxis(const device::JointArray& position, const device::JointArray& target) noexcept {
    Miss worst{Miss::Quantity::axis, 0, 0.0, kAxisTolerance};
    for (std::size_t axis = 0; axis < target.size(); ++axis) {
        if (const double distance = std::abs(position[axis] - target[axis]);
            distance > worst.distance) {
            worst.axis = axis;
            worst.distance = distance;
        }
    }
    return worst;
}

std::string errorNote(int code) {
    return code == 0 ? "" : fmt::format(" (error {}: {})", code, errorText(code));
}

}  // namespace

bool stands(const CabinetState& state) noexcept {
    return std::all_of(state.velocity.begin(), state.velocity.end(),
                       [](double v) { return std::abs(v) < kStandstillSpeed; });
}

std::string toString(const Miss& miss) {
    const bool axis = miss.quantity == Miss::Quantity::axis;
    const std::string_view unit = miss.quantity == Miss::Quantity::position ? "m" : "rad";
    const auto what =
        axis ? fmt::format("axis {}", miss.axis + 1)
             : std::string(miss.quantity == Miss::Quantity::position ? "the tool"
                                                                     : "the tool's orientation");
    return fmt::format("{} {:.4f} {} from its target, limit {:.4f} {}", what, miss.distance, unit,
                       miss.limit, unit);
}

Result<device::MotionOutcome> outcomeOf(const RunEnd& end, const std::string& name,
                                        const std::string& lost) {
    switch (end.cause) {
        case Cause::at_target:
        case Cause::stopped:
        case Cause::force:
            return end.outcome;
        case Cause::refused:
            return fail(Errc::device_fault,
                        fmt::format("{}: the cabinet refused: {}{}", name, describe(end.command),
                                    errorNote(end.error)));
        case Cause::not_ready:
            return fail(Errc::device_fault, fmt::format("{}: not ready to move: {}{}", name,
                                                        toString(end.miss), errorNote(end.error)));
        case Cause::off_target:
            return fail(Errc::device_fault, fmt::format("{}: the motion ended with {}{}", name,
                                                        toString(end.miss), errorNote(end.error)));
        case Cause::stalled:
            return fail(Errc::device_fault,
                        fmt::format("{}: the motion neither went on nor ended: {}{}", name,
                                    toString(end.miss), errorNote(end.error)));
        case Cause::disconnected:
            return fail(Errc::connection_lost, lost);
    }
    return fail(Errc::internal, name + ": a motion ended in no known way");
}

void ControllerPlannedRun::begin(const Request& request, const CabinetState& now,
                                 const CabinetSettings& settings) noexcept {
    *this = ControllerPlannedRun();
    start_ = now.position;
    progress_ = now.position;
    error_before_ = now.last_error;
    condition_new_ = !now.force_condition_met;
    const auto move = moveCommand(request);
    requireSettings(request, settings);
    list_.add(move);
}

Command ControllerPlannedRun::moveCommand(const Request& request) noexcept {
    by_joints_ = !request.motion.target_flange.has_value();
    if (by_joints_) {
        target_joints_ = request.motion.target_joints;
        return moveJoints(target_joints_);
    }
    target_ = motion::toPose(*request.motion.target_flange) * request.flange_from_tool;
    return movePose(motion::toFrame(target_));
}

void ControllerPlannedRun::requireSettings(const Request& request,
                                           const CabinetSettings& settings) noexcept {
    const auto& motion = request.motion;
    const auto require = [&](const Command& command) { settings.require(command, list_); };
    require(chooseInterface(Interface::standard));
    require(jointVelocity(motion.velocity_share));
    require(jointAcceleration(motion.acceleration_share));
    const bool line = motion.path == ControllerPlannedMotion::Path::line;
    if (line) {
        // Also where the motion has none of its own: that of another one may still be in force.
        const auto [velocity, acceleration] =
            std::pair(motion.line_velocity, motion.line_acceleration);
        require(lineVelocity(velocity > 0.0 ? velocity : kOwnLineVelocity));
        require(lineAcceleration(acceleration > 0.0 ? acceleration : kOwnLineAcceleration));
    }
    if (!by_joints_) {
        require(chooseMotionType(line ? MotionType::line : MotionType::ptp));
    }
    require(motion.until ? forceCondition(*motion.until, request.force_tolerance)
                         : forceConditionOff());
}

void ControllerPlannedRun::stop(Cause cause) noexcept {
    if (phase_ != Phase::stopping) {
        phase_ = Phase::stopping;
        stop_cause_ = cause;
    }
}

Command ControllerPlannedRun::command() const noexcept {
    switch (phase_) {
        case Phase::telling:
            return list_.front();
        case Phase::under_way:
            return askState();
        case Phase::stopping:
            return cancelled_ && since_cancel_ < kCancelAgain ? askState() : cancel();
    }
    return askState();
}

bool ControllerPlannedRun::take(const Command& sent, const CabinetState& answer, double step,
                                CabinetSettings& settings) noexcept {
    note(answer);
    switch (phase_) {
        case Phase::telling:
            return told(sent, answer, settings);
        case Phase::under_way:
            return watch(answer, step);
        case Phase::stopping:
            since_cancel_ = sent.code == Code::cancel ? 0.0 : since_cancel_ + step;
            cancelled_ = cancelled_ || sent.code == Code::cancel;
            return brake(answer, step);
    }
    return true;
}

/// Notes the values of the motion's outcome.
void ControllerPlannedRun::note(const CabinetState& answer) noexcept {
    auto& outcome = end_.outcome;
    outcome.force = answer.force;
    outcome.torque = answer.torque;
    for (std::size_t axis = 0; axis < answer.force.size(); ++axis) {
        outcome.largest_force[axis] =
            std::max(outcome.largest_force[axis], std::abs(answer.force[axis]));
    }
    if (answer.last_error != error_before_) {
        end_.error = answer.last_error;
    }
    end_.miss = missOf(answer);
}

bool ControllerPlannedRun::told(const Command& sent, const CabinetState& answer,
                                CabinetSettings& settings) noexcept {
    if (!answer.executed) {
        settings.refused(sent);
        end_.command = sent;
        return overAs(answer.ready ? Cause::refused : Cause::not_ready);
    }
    settings.taken(sent);
    list_.drop();
    if (!list_.empty()) {
        return false;
    }
    phase_ = Phase::under_way;
    return watch(answer, 0.0);
}

bool ControllerPlannedRun::watch(const CabinetState& answer, double step) noexcept {
    const bool moved = device::largestDifference(answer.position, start_) > kAxisTolerance;
    started_ = started_ || answer.active || moved;
    // The flag of the motion before may still stand in the answers until this one has begun.
    condition_new_ = condition_new_ || answer.active || !answer.force_condition_met;
    idle_ = answer.active ? 0.0 : idle_ + step;
    if (stalls(answer, step)) {
        stop(Cause::stalled);
        return false;
    }
    if (answer.active || !stands(answer)) {
        return false;
    }
    const bool begun = started_ || idle_ > kLongestStart;
    if (answer.force_condition_met && (condition_new_ || begun)) {
        return overAs(Cause::force);
    }
    if (begun && end_.miss.within()) {
        return overAs(Cause::at_target);
    }
    if (begun && idle_ > kLongestSettling) {
        return overAs(answer.ready ? Cause::off_target : Cause::not_ready);
    }
    return false;
}

bool ControllerPlannedRun::stalls(const CabinetState& answer, double step) noexcept {
    const bool progress = device::largestDifference(answer.position, progress_) > kLeastProgress;
    if (progress || !answer.active) {
        progress_ = answer.position;
        stalled_ = 0.0;
        return false;
    }
    stalled_ += step;
    return stalled_ > kLongestStall;
}

bool ControllerPlannedRun::brake(const CabinetState& answer, double step) noexcept {
    braking_ += step;
    if (braking_ > kLongestBraking) {
        return overAs(Cause::stalled);
    }
    if (!cancelled_ || answer.active || !stands(answer)) {
        return false;
    }
    const bool arrived = stop_cause_ == Cause::stopped && end_.miss.within();
    return overAs(arrived ? Cause::at_target : stop_cause_);
}

bool ControllerPlannedRun::overAs(Cause cause) noexcept {
    using End = device::MotionOutcome::End;
    end_.cause = cause;
    end_.outcome.end = cause == Cause::force     ? End::force
                       : cause == Cause::stopped ? End::stopped
                                                 : End::at_target;
    return true;
}

Miss ControllerPlannedRun::missOf(const CabinetState& state) const noexcept {
    if (by_joints_) {
        return worstAxis(state.position, target_joints_);
    }
    const auto pose = motion::toPose(state.pose);
    const double distance = motion::distanceBetween(pose, target_);
    if (distance > kPositionTolerance) {
        return {Miss::Quantity::position, 0, distance, kPositionTolerance};
    }
    return {Miss::Quantity::rotation, 0,
            motion::rotationAngleBetween(pose.rotation, target_.rotation), kRotationTolerance};
}

}  // namespace metier::iiwa_driver
