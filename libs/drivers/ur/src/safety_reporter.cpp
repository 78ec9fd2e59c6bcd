#include "safety_reporter.hpp"

#include <fmt/format.h>

#include <utility>

namespace metier::ur_driver {

using device::Safety;
using device::SafetyState;

namespace {

// A message of the controller belongs to a stop that is not farther away than this.
constexpr std::chrono::seconds kReportBefore{1};
constexpr std::chrono::seconds kReportAfter{3};

Safety judgeSafety(SafetyMode mode) {
    const auto text = toText(mode);
    switch (mode) {
        case SafetyMode::normal:
        case SafetyMode::reduced:
            return {SafetyState::normal, {}};
        case SafetyMode::protective_stop:
            return {SafetyState::protective_stop, text + ": clear its cause, then Reset"};
        case SafetyMode::safeguard_stop:
        case SafetyMode::automatic_mode_safeguard_stop:
        case SafetyMode::system_three_position_enabling_stop:
        case SafetyMode::pendant_three_position_enabling_stop:
        case SafetyMode::immi_safeguard_stop:
        case SafetyMode::profisafe_automatic_mode_safeguard_stop:
        case SafetyMode::profisafe_safeguard_stop:
        case SafetyMode::safety_api_safeguard_stop:
            return {SafetyState::protective_stop, text + ": close the safeguard, then Reset"};
        case SafetyMode::system_emergency_stop:
        case SafetyMode::robot_emergency_stop:
        case SafetyMode::immi_emergency_stop:
        case SafetyMode::profisafe_emergency_stop:
            return {SafetyState::emergency_stop, text + ": release it, then Reset"};
        case SafetyMode::recovery:
            return {SafetyState::fault,
                    text + ": an axis is outside of its limits; move it back at the pendant"};
        case SafetyMode::violation:
        case SafetyMode::fault:
            return {SafetyState::fault, text + ": restart the safety system at the pendant"};
        case SafetyMode::validate_joint_id:
        case SafetyMode::undefined:
        case SafetyMode::profisafe_waiting:
            break;
    }
    return {SafetyState::fault, text + ": see the pendant"};
}

Safety judgeMode(RobotMode mode) {
    const auto text = "robot mode " + toText(mode);
    switch (mode) {
        case RobotMode::running:
            return {SafetyState::normal, {}};
        case RobotMode::power_off:
        case RobotMode::power_on:
        case RobotMode::idle:
            return {SafetyState::fault, text + ": power on and release the brakes, or Reset"};
        case RobotMode::backdrive:
            return {SafetyState::fault, text + ": someone moves the arm by hand"};
        case RobotMode::confirm_safety:
            return {SafetyState::fault, text + ": confirm the safety settings at the pendant"};
        case RobotMode::no_controller:
        case RobotMode::disconnected:
        case RobotMode::booting:
        case RobotMode::updating_firmware:
            break;
    }
    return {SafetyState::fault, text + ": wait until the controller is ready, or see the pendant"};
}

}  // namespace

Safety judge(RobotMode robot_mode, SafetyMode safety_mode) {
    auto safety = judgeSafety(safety_mode);
    return safety.state == SafetyState::normal ? judgeMode(robot_mode) : safety;
}

SafetyReporter::SafetyReporter(device::ArmCore& core, std::function<void()> tell)
    : core_(core), tell_(std::move(tell)) {}

void SafetyReporter::observe(const ControllerState& now, bool limit_broken, SteadyTime stamp) {
    const Modes modes{now.robot_mode, now.safety_mode};
    if (connected_.load() && modes == seen_) {
        return;
    }
    seen_ = modes;
    connected_.store(true);
    const std::lock_guard lock(mutex_);
    modes_ = modes;
    limit_broken_ = limit_broken && modes.safety == SafetyMode::protective_stop;
    update(stamp);
}

void SafetyReporter::disconnected(const std::string& why, SteadyTime now) {
    connected_.store(false);
    const std::lock_guard lock(mutex_);
    link_text_ = why;
    latch_text_.clear();  // the reason of the stop is over when the arm is back
    update(now);
}

void SafetyReporter::latch(const std::string& why, SteadyTime now) {
    const std::lock_guard lock(mutex_);
    if (latch_text_.empty()) {
        latch_text_ = why;
        update(now);
    }
}

void SafetyReporter::unlatch() {
    const std::lock_guard lock(mutex_);
    latch_text_.clear();
    update(since_);
}

bool SafetyReporter::latched() const {
    const std::lock_guard lock(mutex_);
    return !latch_text_.empty();
}

void SafetyReporter::report(const primary::Report& report, SteadyTime now) {
    using Level = primary::Report::Level;
    using Kind = primary::Report::Kind;
    const bool only_the_mode = report.kind == Kind::safety && report.code == 0;
    if (report.kind == Kind::text || report.level < Level::warning || only_the_mode) {
        return;
    }
    const std::lock_guard lock(mutex_);
    report_text_ = report.toText();
    report_stamp_ = now;
    if (last_ != SafetyState::normal && now < since_ + kReportAfter) {
        update(since_);
    }
}

void SafetyReporter::note(const std::string& text) {
    const std::lock_guard lock(mutex_);
    if (note_ != text) {
        note_ = text;
        update(since_);
    }
}

SteadyTime SafetyReporter::since() const {
    const std::lock_guard lock(mutex_);
    return since_;
}

Safety SafetyReporter::compose() const {
    if (!connected_.load()) {
        return {SafetyState::disconnected, link_text_.empty() ? "not connected yet" : link_text_};
    }
    auto safety = judge(modes_.robot, modes_.safety);
    safety.limit_violated = limit_broken_;
    if (safety.state == SafetyState::normal && !latch_text_.empty()) {
        safety = {SafetyState::protective_stop, latch_text_ + "; then Reset"};
    }
    return safety;
}

void SafetyReporter::update(SteadyTime now) {
    auto safety = compose();
    if (safety.state != last_) {
        last_ = safety.state;
        since_ = now;
    }
    const bool stopped =
        safety.state != SafetyState::normal && safety.state != SafetyState::disconnected;
    if (stopped && !report_text_.empty() && report_stamp_ > since_ - kReportBefore) {
        safety.text += " (the controller says: " + report_text_ + ")";
    }
    if (safety.text.empty()) {
        safety.text = note_;
    }
    if (!safety.text.empty()) {
        safety.text = core_.info().name + ": " + safety.text;
    }
    core_.setSafety(std::move(safety));
    tell_();
}

}  // namespace metier::ur_driver
