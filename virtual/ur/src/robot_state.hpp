#pragma once

#include <array>
#include <bitset>
#include <cstdint>
#include <string>

namespace metier::virtual_ur {

using Vector3 = std::array<double, 3>;
using Vector6 = std::array<double, 6>;

inline constexpr std::size_t kAxes = 6;

enum class Series : std::uint8_t { cb3, e_series };

// The enumerators of the maker, with the numbers that are sent.
enum class RobotMode : std::int8_t {
    no_controller = -1,
    disconnected,
    confirm_safety,
    booting,
    power_off,
    power_on,
    idle,
    backdrive,
    running,
};
enum class SafetyMode : std::uint8_t {
    normal = 1,
    reduced,
    protective_stop,
    recovery,
    safeguard_stop,
    system_emergency_stop,
    robot_emergency_stop,
    violation,
    fault,
};
enum class RuntimeState : std::uint8_t { stopping, stopped, playing, pausing, paused, resuming };
enum class JointMode : std::uint8_t { power_off = 239, booting = 247, running = 253, idle = 255 };

/// General purpose registers: one bank that clients write, one that scripts write.
struct Registers {
    std::bitset<128> bits;
    std::array<std::int32_t, 48> integers{};
    std::array<double, 48> numbers{};
};

/// Inputs and outputs of control box and tool. Bits 0-7 standard, 8-15 configurable, 16-17 tool.
struct InputsOutputs {
    std::uint64_t digital_inputs = 0;
    std::uint64_t digital_outputs = 0;
    std::array<double, 2> analog_inputs{};                ///< [V] or [A]
    std::array<double, 2> analog_outputs{};               ///< [V] or [A]
    std::array<std::uint8_t, 2> analog_input_domains{};   ///< 0 current, 1 voltage
    std::array<std::uint8_t, 2> analog_output_domains{};  ///< 0 current, 1 voltage
    std::array<double, 2> tool_analog_inputs{};           ///< [V] or [A]
    std::array<std::uint8_t, 2> tool_analog_input_domains{};
    std::int32_t tool_voltage = 0;  ///< 0, 12, 24 [V]
};

/// Everything that is sent of the virtual arm; written once per cycle, read by every port.
/// SI, radians; poses are x, y, z and the rotation vector, in the base frame.
struct RobotState {
    std::uint64_t cycle = 0;  ///< number of the controller's cycle; never jumps
    double timestamp = 0.0;   ///< exactly cycle times period [s]

    Vector6 target_q{};
    Vector6 target_qd{};
    Vector6 target_qdd{};
    Vector6 actual_q{};
    Vector6 actual_qd{};
    Vector6 target_tcp_pose{};
    Vector6 actual_tcp_pose{};
    Vector6 target_tcp_speed{};
    Vector6 actual_tcp_speed{};
    Vector6 actual_tcp_force{};  ///< [N], [Nm] on the tool centre point, base frame
    Vector6 raw_wrench{};        ///< the same at the flange, in the flange frame
    Vector6 force_bias{};        ///< taken off actual_tcp_force by zero_ftsensor()
    Vector6 tcp_offset{};
    Vector3 elbow_position{};
    Vector3 elbow_velocity{};

    RobotMode robot_mode = RobotMode::power_off;
    SafetyMode safety_mode = SafetyMode::normal;
    RuntimeState runtime_state = RuntimeState::stopped;
    std::uint32_t safety_status_bits = 1;
    std::uint32_t robot_status_bits = 0;
    std::array<std::int32_t, kAxes> joint_mode{};
    std::uint32_t script_line = 0;

    double speed_slider = 1.0;   ///< requested speed, 0 to 1
    double speed_scaling = 1.0;  ///< factor of the trajectory limiter, 0 to 1; the arm moves with
                                 ///< it times the slider

    double payload = 0.0;  ///< [kg]
    Vector3 payload_cog{};
    Vector6 payload_inertia{};
    Vector3 gravity{0.0, 0.0, 9.82};  ///< [m/s2]; the direction the base pushes back

    InputsOutputs io;
    Registers inputs;
    Registers outputs;

    double main_voltage = 0.0;
    double robot_voltage = 0.0;
    double robot_current = 0.0;
    Vector6 joint_voltage{};
    Vector6 joint_temperature{};
};

/// Inputs that clients write besides registers, with the maker's names.
struct ControlInputs {
    std::uint32_t speed_slider_mask = 0;
    double speed_slider_fraction = 1.0;
    std::uint8_t standard_digital_output_mask = 0;
    std::uint8_t standard_digital_output = 0;
    std::uint8_t configurable_digital_output_mask = 0;
    std::uint8_t configurable_digital_output = 0;
    std::uint8_t tool_digital_output_mask = 0;
    std::uint8_t tool_digital_output = 0;
    std::uint8_t standard_analog_output_mask = 0;
    std::uint8_t standard_analog_output_type = 0;
    std::array<double, 2> standard_analog_output{};  ///< share, 0 to 1
    Vector6 external_force_torque{};
};

/// Names in the dashboard's spelling: "POWER_OFF", "PROTECTIVE_STOP".
std::string toText(RobotMode mode);
std::string toText(SafetyMode mode);

}  // namespace metier::virtual_ur
