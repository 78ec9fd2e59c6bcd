#pragma once

#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "metier/urscript/value.hpp"

namespace metier::urscript {

// Commands of a script that take effect at once. SI units and radians; tool flange frame unless
// stated otherwise.

struct SetPayload {
    double mass = 0.0;               ///< [kg]
    std::optional<Vector3> cog;      ///< centre of gravity [m]; absent: unchanged
    std::optional<Vector6> inertia;  ///< Ixx, Iyy, Izz, Ixy, Ixz, Iyz [kg m^2]
};
struct SetTargetPayload : SetPayload {
    double transition_time = 0.0;  ///< [s]
};
struct SetTcp {
    Pose flange_from_tool;
};
struct SetGravity {
    Vector3 gravity{};  ///< base frame [m/s^2]
};
struct SetToolVoltage {
    int voltage = 0;  ///< 0, 12 or 24 [V]
};
struct ForceMode {
    Pose task_frame;      ///< base_from_task
    Vector6 selection{};  ///< 1: compliant axis
    Vector6 wrench{};     ///< [N], [Nm]
    int type = 2;         ///< 1 to 3
    Vector6 limits{};     ///< compliant axis: speed [m/s], [rad/s]; else deviation [m], [rad]
};
struct EndForceMode {};
struct ForceModeDamping {
    double damping = 0.0;  ///< 0 to 1
};
struct ForceModeGainScaling {
    double scaling = 1.0;  ///< 0 to 2
};
struct FreedriveMode {
    Vector6 free_axes{1, 1, 1, 1, 1, 1};
};
struct EndFreedriveMode {};
struct ZeroForceSensor {};
/// `ft_rtde_input_enable`, `enable_external_ft_sensor`.
struct ForceSensorInput {
    bool enable = false;
    double mass = 0.0;  ///< [kg]
    Vector3 offset{};   ///< [m]
    Vector3 cog{};      ///< [m]
};
struct RtdeWatchdog {
    std::string variable;          ///< such as "input_int_register_0"
    double min_frequency = 0.0;    ///< [Hz]
    std::string action = "pause";  ///< "ignore", "pause" or "stop"
};
/// `set_analog_inputrange`, `set_standard_analog_input_domain`, `set_analog_outputdomain`, ...
struct AnalogDomain {
    enum class Port { standard_input, standard_output, tool_input };
    Port port = Port::standard_input;
    int index = 0;
    int domain = 0;  ///< 0 current, 1 voltage
};
struct PowerDown {};
/// `protective_stop`: the controller stops the arm, as if it had found a fault.
struct ProtectiveStop {};
/// A function that exists but has no effect visible to other functions, such as
/// `set_tool_communication`.
struct OtherCommand {
    std::string name;
    std::vector<Value> arguments;
};

using Command = std::variant<SetPayload, SetTargetPayload, SetTcp, SetGravity, SetToolVoltage,
                             ForceMode, EndForceMode, ForceModeDamping, ForceModeGainScaling,
                             FreedriveMode, EndFreedriveMode, ZeroForceSensor, ForceSensorInput,
                             RtdeWatchdog, AnalogDomain, PowerDown, ProtectiveStop, OtherCommand>;

}  // namespace metier::urscript
