// The outputs that have no number, by name.

#include <array>
#include <cmath>

#include "rtde_variables.hpp"

namespace metier::virtual_ur {

namespace {

using Output = RtdeOutput;
using State = RobotState;

template <auto member>
constexpr Output value(std::string_view name) {
    return {name, [](const State& s, std::size_t) { return RtdeValue(s.*member); }};
}
template <auto member>
constexpr Output number(std::string_view name) {
    return {name, [](const State& s, std::size_t) {
                return RtdeValue(static_cast<std::int32_t>(s.*member));
            }};
}
template <typename T>
constexpr Output zero(std::string_view name) {
    return {name, [](const State&, std::size_t) { return RtdeValue(T{}); }};
}
template <auto member, std::size_t index>
constexpr Output element(std::string_view name) {
    return {name, [](const State& s, std::size_t) { return RtdeValue((s.io.*member)[index]); }};
}

std::uint32_t domains(const std::array<std::uint8_t, 2>& of) {
    return static_cast<std::uint32_t>(of[0] | of[1] << 1);
}
double forceOf(const State& s) {
    return std::hypot(s.actual_tcp_force[0], s.actual_tcp_force[1], s.actual_tcp_force[2]);
}
constexpr std::uint64_t kConfigurable = 0xFF00;

using Io = InputsOutputs;
constexpr std::array kOutputs{
    // motion
    value<&State::timestamp>("timestamp"),
    value<&State::target_q>("target_q"),
    value<&State::target_qd>("target_qd"),
    value<&State::target_qdd>("target_qdd"),
    value<&State::actual_q>("actual_q"),
    value<&State::actual_qd>("actual_qd"),
    value<&State::actual_tcp_pose>("actual_TCP_pose"),
    value<&State::actual_tcp_speed>("actual_TCP_speed"),
    value<&State::actual_tcp_force>("actual_TCP_force"),
    value<&State::target_tcp_pose>("target_TCP_pose"),
    value<&State::target_tcp_speed>("target_TCP_speed"),
    value<&State::tcp_offset>("tcp_offset"),
    value<&State::elbow_position>("elbow_position"),
    value<&State::elbow_velocity>("elbow_velocity"),
    value<&State::raw_wrench>("ft_raw_wrench"),
    Output{"tcp_force_scalar", [](const State& s, std::size_t) { return RtdeValue(forceOf(s)); }},
    zero<Vector6>("target_current"),
    zero<Vector6>("target_moment"),
    zero<Vector6>("actual_current"),
    zero<Vector6>("actual_current_window"),
    zero<Vector6>("actual_current_as_torque"),
    zero<Vector6>("joint_control_output"),
    zero<Vector6>("actual_TCP_acceleration"),
    zero<Vector6>("target_TCP_acceleration"),
    zero<Vector6>("wrench_calc_from_currents"),
    zero<Vector6>("target_base_acceleration"),
    zero<Vector6>("target_base_wrench"),
    zero<Vector3>("actual_tool_accelerometer"),
    zero<double>("actual_momentum"),
    zero<double>("joint_position_deviation_ratio"),
    zero<double>("collision_detection_ratio"),

    // modes and what the robot is like
    number<&State::robot_mode>("robot_mode"),
    number<&State::safety_mode>("safety_mode"),
    number<&State::safety_mode>("safety_status"),
    value<&State::joint_mode>("joint_mode"),
    value<&State::robot_status_bits>("robot_status_bits"),
    value<&State::safety_status_bits>("safety_status_bits"),
    value<&State::script_line>("script_control_line"),
    value<&State::speed_scaling>("speed_scaling"),
    value<&State::speed_slider>("target_speed_fraction"),
    value<&State::cycle>("control_step"),
    value<&State::payload>("payload"),
    value<&State::payload_cog>("payload_cog"),
    value<&State::payload_inertia>("payload_inertia"),
    value<&State::gravity>("target_gravity"),
    value<&State::main_voltage>("actual_main_voltage"),
    value<&State::robot_voltage>("actual_robot_voltage"),
    value<&State::robot_current>("actual_robot_current"),
    value<&State::joint_voltage>("actual_joint_voltage"),
    value<&State::joint_temperature>("joint_temperatures"),
    Output{"runtime_state",
           [](const State& s, std::size_t) {
               return RtdeValue(static_cast<std::uint32_t>(s.runtime_state));
           }},
    zero<double>("actual_execution_time"),
    zero<double>("target_execution_time"),
    zero<double>("actual_robot_energy_consumed"),
    zero<double>("actual_robot_braking_energy_dissipated"),
    zero<std::int32_t>("time_scale_source"),

    // inputs and outputs
    Output{"actual_digital_input_bits",
           [](const State& s, std::size_t) { return RtdeValue(s.io.digital_inputs); }},
    Output{"actual_digital_output_bits",
           [](const State& s, std::size_t) { return RtdeValue(s.io.digital_outputs); }},
    Output{"actual_configurable_digital_input_bits",
           [](const State& s, std::size_t) {
               return RtdeValue((s.io.digital_inputs & kConfigurable) >> 8U);
           }},
    Output{"actual_configurable_digital_output_bits",
           [](const State& s, std::size_t) {
               return RtdeValue((s.io.digital_outputs & kConfigurable) >> 8U);
           }},
    Output{"analog_io_types",
           [](const State& s, std::size_t) {
               return RtdeValue(domains(s.io.analog_input_domains) |
                                domains(s.io.analog_output_domains) << 2U);
           }},
    Output{"tool_analog_input_types",
           [](const State& s, std::size_t) {
               return RtdeValue(domains(s.io.tool_analog_input_domains));
           }},
    Output{"tool_output_voltage",
           [](const State& s, std::size_t) { return RtdeValue(s.io.tool_voltage); }},
    element<&Io::analog_inputs, 0>("standard_analog_input0"),
    element<&Io::analog_inputs, 1>("standard_analog_input1"),
    element<&Io::analog_outputs, 0>("standard_analog_output0"),
    element<&Io::analog_outputs, 1>("standard_analog_output1"),
    element<&Io::tool_analog_inputs, 0>("tool_analog_input0"),
    element<&Io::tool_analog_inputs, 1>("tool_analog_input1"),
    zero<double>("io_current"),
    zero<double>("tool_output_current"),
    zero<double>("tool_temperature"),
    zero<double>("euromap67_24V_voltage"),
    zero<double>("euromap67_24V_current"),
    zero<std::uint32_t>("euromap67_input_bits"),
    zero<std::uint32_t>("euromap67_output_bits"),
    zero<std::uint32_t>("tool_mode"),
    zero<std::uint8_t>("tool_output_mode"),
    zero<std::uint8_t>("tool_digital_output0_mode"),
    zero<std::uint8_t>("tool_digital_output1_mode"),
    zero<std::int32_t>("encoder0_raw"),
    zero<std::int32_t>("encoder1_raw"),
};

}  // namespace

std::span<const RtdeOutput> rtdeOutputs() {
    return kOutputs;
}

}  // namespace metier::virtual_ur
