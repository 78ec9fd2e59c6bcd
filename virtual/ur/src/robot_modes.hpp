#pragma once

#include "metier/base/error.hpp"
#include "robot_state.hpp"

namespace metier::virtual_ur {

/// Durations of the transitions [s].
struct ModeTimes {
    double power_on = 1.0;
    double brake_release = 0.5;
    /// A protective stop cannot be unlocked sooner (believed to be 5 s).
    double unlock_delay = 5.0;
};

enum class PowerAtStart : std::uint8_t { off, running };

/// The robot's and the safety system's modes and what leads from one to the other.
///
/// Threading: one thread, the cycle.
class RobotModes {
public:
    RobotModes(const ModeTimes& times, PowerAtStart power);

    /// \param standing whether the arm stands: only then power goes off
    void step(double seconds, bool standing);

    // Requests of the panel, the dashboard and the script ports.
    /// Errors of both: invalid_state in an emergency stop or a fault.
    Result<void> powerOn();
    /// Powers on first if need be.
    Result<void> releaseBrakes();
    void powerOff();
    /// Errors: invalid_state with the maker's text, too soon or not stopped.
    Result<void> unlock();
    void restartSafety();

    // Events that happen to the robot.
    void protectiveStop() { interrupt(SafetyMode::protective_stop); }
    void emergencyStop();
    void releaseEmergencyStop() { leave(SafetyMode::robot_emergency_stop); }
    void safeguardStop() { interrupt(SafetyMode::safeguard_stop); }
    void closeSafeguard() { leave(SafetyMode::safeguard_stop); }
    /// Violation, which lasts until the safety system is restarted.
    void violation();
    /// An axis is outside of its safety limits; programs may not run until it is moved back.
    void recovery() { interrupt(SafetyMode::recovery); }
    void endRecovery() { leave(SafetyMode::recovery); }

    RobotMode robotMode() const { return robot_; }
    SafetyMode safetyMode() const { return safety_; }
    std::uint32_t safetyStatusBits() const;
    JointMode jointMode() const;
    /// Reports whether a program may begin or go on.
    bool mayRun() const { return robot_ == RobotMode::running && safety_ == SafetyMode::normal; }
    bool emergencyStopped() const { return safety_ == SafetyMode::robot_emergency_stop; }

private:
    Result<void> refuseUnlessSafe() const;
    void enter(SafetyMode mode);
    /// Enters the mode if a program may run.
    void interrupt(SafetyMode mode);
    /// Becomes normal if the mode is this one.
    void leave(SafetyMode mode);

    const ModeTimes times_;
    RobotMode robot_;
    SafetyMode safety_ = SafetyMode::normal;
    double in_mode_ = 0.0;    // time in the present robot mode [s]
    double in_safety_ = 0.0;  // time in the present safety mode [s]
    bool release_brakes_ = false;
    bool powering_off_ = false;
};

}  // namespace metier::virtual_ur
