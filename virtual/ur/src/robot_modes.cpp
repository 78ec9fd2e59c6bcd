#include "robot_modes.hpp"

#include <array>

namespace metier::virtual_ur {

namespace {

constexpr std::array kSafetyModes{"NORMAL",
                                  "REDUCED",
                                  "PROTECTIVE_STOP",
                                  "RECOVERY",
                                  "SAFEGUARD_STOP",
                                  "SYSTEM_EMERGENCY_STOP",
                                  "ROBOT_EMERGENCY_STOP",
                                  "VIOLATION",
                                  "FAULT"};

constexpr std::array kRobotModes{"NO_CONTROLLER", "DISCONNECTED", "CONFIRM_SAFETY",
                                 "BOOTING",       "POWER_OFF",    "POWER_ON",
                                 "IDLE",          "BACKDRIVE",    "RUNNING"};

constexpr std::uint32_t bit(unsigned number) {
    return 1U << number;
}

// Bits of safety_status_bits.
constexpr std::uint32_t kNormal = bit(0);
constexpr std::uint32_t kProtective = bit(2);
constexpr std::uint32_t kRecovery = bit(3);
constexpr std::uint32_t kSafeguard = bit(4);
constexpr std::uint32_t kRobotEmergency = bit(6);
constexpr std::uint32_t kEmergency = bit(7);
constexpr std::uint32_t kViolation = bit(8);
constexpr std::uint32_t kStopped = bit(10);

}  // namespace

RobotModes::RobotModes(const ModeTimes& times, PowerAtStart power)
    : times_(times),
      robot_(power == PowerAtStart::running ? RobotMode::running : RobotMode::power_off) {}

void RobotModes::step(double seconds, bool standing) {
    in_mode_ += seconds;
    in_safety_ += seconds;
    const auto enter = [this](RobotMode mode) {
        robot_ = mode;
        in_mode_ = 0.0;
    };
    if (powering_off_) {
        if (standing) {
            powering_off_ = false;
            release_brakes_ = false;
            enter(RobotMode::power_off);
        }
    } else if (robot_ == RobotMode::booting && in_mode_ >= times_.power_on / 2.0) {
        enter(RobotMode::power_on);
    } else if (robot_ == RobotMode::power_on && in_mode_ >= times_.power_on / 2.0) {
        enter(RobotMode::idle);
    } else if (robot_ == RobotMode::idle && release_brakes_ && in_mode_ >= times_.brake_release) {
        release_brakes_ = false;
        enter(RobotMode::running);
    }
}

void RobotModes::enter(SafetyMode mode) {
    safety_ = mode;
    in_safety_ = 0.0;
}

Result<void> RobotModes::refuseUnlessSafe() const {
    if (safety_ == SafetyMode::normal || safety_ == SafetyMode::protective_stop) {
        return {};
    }
    return fail(Errc::invalid_state, "safety mode is " + toText(safety_));
}

Result<void> RobotModes::powerOn() {
    return refuseUnlessSafe().map([this] {
        if (robot_ == RobotMode::power_off) {
            robot_ = RobotMode::booting;
            in_mode_ = 0.0;
        }
    });
}

Result<void> RobotModes::releaseBrakes() {
    return powerOn().map([this] {
        if (robot_ == RobotMode::running) {
            return;
        }
        if (robot_ == RobotMode::idle) {
            in_mode_ = 0.0;
        }
        release_brakes_ = true;
    });
}

void RobotModes::powerOff() {
    powering_off_ = robot_ != RobotMode::power_off;
}

Result<void> RobotModes::unlock() {
    if (safety_ != SafetyMode::protective_stop) {
        return fail(Errc::invalid_state, "Failed to execute: unlock protective stop");
    }
    if (in_safety_ < times_.unlock_delay) {
        return fail(Errc::invalid_state,
                    "Cannot unlock protective stop until 5s after occurrence. "
                    "Always inspect cause of protective stop before unlocking");
    }
    enter(SafetyMode::normal);
    return {};
}

void RobotModes::restartSafety() {
    if (!emergencyStopped()) {
        enter(SafetyMode::normal);
    }
    powerOff();
}

void RobotModes::interrupt(SafetyMode mode) {
    if (mayRun()) {
        enter(mode);
    }
}

void RobotModes::leave(SafetyMode mode) {
    if (safety_ == mode) {
        enter(SafetyMode::normal);
    }
}

void RobotModes::emergencyStop() {
    enter(SafetyMode::robot_emergency_stop);
    powerOff();
}

void RobotModes::violation() {
    enter(SafetyMode::violation);
    powerOff();
}

std::uint32_t RobotModes::safetyStatusBits() const {
    switch (safety_) {
        case SafetyMode::protective_stop:
            return kProtective | kStopped;
        case SafetyMode::recovery:
            return kRecovery;
        case SafetyMode::safeguard_stop:
            return kSafeguard | kStopped;
        case SafetyMode::violation:
            return kViolation | kStopped;
        case SafetyMode::robot_emergency_stop:
            return kRobotEmergency | kEmergency | kStopped;
        default:
            return kNormal;
    }
}

JointMode RobotModes::jointMode() const {
    switch (robot_) {
        case RobotMode::running:
            return JointMode::running;
        case RobotMode::idle:
        case RobotMode::power_on:
            return JointMode::idle;
        case RobotMode::booting:
            return JointMode::booting;
        default:
            return JointMode::power_off;
    }
}

std::string toText(RobotMode mode) {
    return kRobotModes.at(static_cast<std::size_t>(static_cast<int>(mode) + 1));
}

std::string toText(SafetyMode mode) {
    return kSafetyModes.at(static_cast<std::size_t>(mode) - 1);
}

}  // namespace metier::virtual_ur
