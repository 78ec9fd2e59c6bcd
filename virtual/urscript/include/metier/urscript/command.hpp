#pragma once

#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "metier/urscript/value.hpp"

namespace metier::urscript {

// Commands of a script that take effect at once: Robot::apply() gets them. SI units and radians;
// tool flange frame unless stated otherwise. Source: URScript manual.

/// `set_payload`: the load at the flange.
struct SetPayload {
    /// Mass [kg].
    double mass = 0.0;
    /// Centre of gravity [m]; absent: unchanged.
    std::optional<Vector3> cog;
    /// Ixx, Iyy, Izz, Ixy, Ixz, Iyz [kg m^2]; absent: unchanged.
    std::optional<Vector6> inertia;
};
/// `set_target_payload`: a load that comes gradually.
struct SetTargetPayload : SetPayload {
    /// Time over which the load changes [s].
    double transition_time = 0.0;
};
/// `set_tcp`: the tool frame of all following poses.
struct SetTcp {
    /// Place of the tool frame on the flange.
    Pose flange_from_tool;
};
/// `set_gravity`: direction in which the arm is mounted.
struct SetGravity {
    /// Vector of the script, in the base frame [m/s^2].
    Vector3 gravity{};
};
/// `set_tool_voltage`.
struct SetToolVoltage {
    /// Voltage of the tool's connector: 0, 12 or 24 [V].
    int voltage = 0;
};
/// `force_mode`: the arm gives way along some axes.
struct ForceMode {
    /// base_from_task: frame of the axes below.
    Pose task_frame;
    /// One number per axis; 1: compliant axis.
    Vector6 selection{};
    /// Wrench that the arm applies along compliant axes [N], [N m].
    Vector6 wrench{};
    /// Way in which the task frame follows the arm, 1 to 3.
    int type = 2;
    /// Limit of each axis: of a compliant one, speed [m/s], [rad/s]; else deviation [m], [rad].
    Vector6 limits{};
};
/// `end_force_mode`.
struct EndForceMode {};
/// `force_mode_set_damping`.
struct ForceModeDamping {
    /// Damping, 0 to 1.
    double damping = 0.0;
};
/// `force_mode_set_gain_scaling`.
struct ForceModeGainScaling {
    /// Factor of the gain, 0 to 2.
    double scaling = 1.0;
};
/// `freedrive_mode`: the arm can be moved by hand.
struct FreedriveMode {
    /// One number per axis; 1: free.
    Vector6 free_axes{1, 1, 1, 1, 1, 1};
};
/// `end_freedrive_mode`.
struct EndFreedriveMode {};
/// `zero_ftsensor`: takes the present wrench as zero.
struct ZeroForceSensor {};
/// `ft_rtde_input_enable`, `enable_external_ft_sensor`.
struct ForceSensorInput {
    /// Whether the wrench comes from outside of the controller.
    bool enable = false;
    /// Mass of the sensor [kg].
    double mass = 0.0;
    /// Place of the sensor on the flange [m].
    Vector3 offset{};
    /// Centre of gravity of the sensor [m].
    Vector3 cog{};
};
/// `rtde_set_watchdog`: a register that must be written often enough.
struct RtdeWatchdog {
    /// Name of the register: "input_int_register_0".
    std::string variable;
    /// Least frequency of writes [Hz].
    double min_frequency = 0.0;
    /// Consequence of a write that is late: "ignore", "pause" or "stop".
    std::string action = "pause";
};
/// `set_analog_inputrange`, `set_standard_analog_input_domain`, `set_analog_outputdomain`, ...
struct AnalogDomain {
    /// Connector.
    enum class Port { standard_input, standard_output, tool_input };
    /// Connector of the channel.
    Port port = Port::standard_input;
    /// Channel, counted from 0.
    int index = 0;
    /// Quantity: 0 current, 1 voltage.
    int domain = 0;
};
/// `powerdown`: switches arm and controller off.
struct PowerDown {};
/// `protective_stop`: the controller stops the arm, as if it had found a fault.
struct ProtectiveStop {};
/// A function that exists but has no effect visible to other functions, such as
/// `set_tool_communication`.
struct OtherCommand {
    /// Name of the function.
    std::string name;
    /// Its arguments, in order.
    std::vector<Value> arguments;
};

/// Any of these.
using Command = std::variant<SetPayload, SetTargetPayload, SetTcp, SetGravity, SetToolVoltage,
                             ForceMode, EndForceMode, ForceModeDamping, ForceModeGainScaling,
                             FreedriveMode, EndFreedriveMode, ZeroForceSensor, ForceSensorInput,
                             RtdeWatchdog, AnalogDomain, PowerDown, ProtectiveStop, OtherCommand>;

}  // namespace metier::urscript
