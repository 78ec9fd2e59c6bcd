#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>

namespace metier::ur_driver {

inline constexpr std::size_t kAxes = 6;
using Joints = std::array<double, kAxes>;

/// Source: docs/protocols/ur.md#modes.
enum class RobotMode : std::int32_t {
    no_controller = -1,
    disconnected = 0,
    confirm_safety = 1,
    booting = 2,
    power_off = 3,
    power_on = 4,
    idle = 5,
    backdrive = 6,
    running = 7,
    updating_firmware = 8,
};

/// safety_mode and safety_status share their numbers. Source: docs/protocols/ur.md#modes.
enum class SafetyMode : std::int32_t {
    normal = 1,
    reduced = 2,
    protective_stop = 3,
    recovery = 4,
    safeguard_stop = 5,
    system_emergency_stop = 6,
    robot_emergency_stop = 7,
    violation = 8,
    fault = 9,
    validate_joint_id = 10,
    undefined = 11,
    automatic_mode_safeguard_stop = 12,
    system_three_position_enabling_stop = 13,
    pendant_three_position_enabling_stop = 14,
    immi_emergency_stop = 15,
    immi_safeguard_stop = 16,
    profisafe_waiting = 17,
    profisafe_automatic_mode_safeguard_stop = 18,
    profisafe_safeguard_stop = 19,
    profisafe_emergency_stop = 20,
    safety_api_safeguard_stop = 22,
};

/// State of the controller's program. Source: docs/protocols/ur.md#modes.
enum class RuntimeState : std::uint32_t {
    stopping = 0,
    stopped = 1,
    playing = 2,
    pausing = 3,
    paused = 4,
    resuming = 5,
};

/// "POWER_OFF", as the controller's panel spells it; "mode 42" for an unknown one.
std::string toText(RobotMode mode);
/// "protective stop"; "safety mode 42" for an unknown one.
std::string toText(SafetyMode mode);
/// "playing"; "state 42" for an unknown one.
std::string toText(RuntimeState state);

/// Factor of the trajectory limiter, and fraction of the slider, from which an arm moves as
/// commanded.
inline constexpr double kFullSpeed = 0.99;

/// One data package of RTDE. Trivially copyable.
struct ControllerState {
    double timestamp = 0.0;  ///< time since the controller started [s]
    Joints target_q{};       ///< [rad]
    Joints actual_q{};       ///< [rad]
    Joints actual_qd{};      ///< [rad/s]
    RobotMode robot_mode = RobotMode::no_controller;
    SafetyMode safety_mode = SafetyMode::undefined;
    RuntimeState runtime_state = RuntimeState::stopped;
    double speed_scaling = 1.0;          ///< factor of the trajectory limiter; 1: the arm moves as
                                         ///< commanded
    double target_speed_fraction = 1.0;  ///< the speed slider, 1: 100 %
    std::int32_t script_token = 0;       ///< written by the script that follows set-points
    std::int32_t script_counter = 0;     ///< the last set-point that it took
};

}  // namespace metier::ur_driver
