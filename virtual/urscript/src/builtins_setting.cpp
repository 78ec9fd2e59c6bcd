
#include "call.hpp"
#include "metier/base/text.hpp"

namespace metier::urscript {
namespace {

/// A command that has no arguments, or whose arguments make no difference.
template <typename T>
Value simple(Call& call) {
    return call.applies(T{});
}

void readPayload(Call& call, SetPayload& payload) {
    payload.mass = call.number(0);
    if (call.given(1)) {
        payload.cog = call.vector3(1);
    }
    if (call.given(2)) {
        payload.inertia = call.vector6(2);
    }
}

Value setPayload(Call& call) {
    SetPayload payload;
    readPayload(call, payload);
    return call.applies(payload);
}

Value setTargetPayload(Call& call) {
    SetTargetPayload payload;
    readPayload(call, payload);
    payload.transition_time = call.number(3, 0.0);
    return call.applies(payload);
}

Value setPayloadMass(Call& call) {
    SetPayload payload;
    payload.mass = call.number(0);
    return call.applies(payload);
}

Value setPayloadCog(Call& call) {
    SetPayload payload;
    payload.mass = call.robot().state().payload_mass;
    payload.cog = call.vector3(0);
    return call.applies(payload);
}

Value forceMode(Call& call) {
    ForceMode force;
    force.task_frame = call.pose(0);
    force.selection = call.vector6(1);
    force.wrench = call.vector6(2);
    force.type = call.integer(3);
    force.limits = call.vector6(4);
    return call.applies(force);
}

Value freedriveMode(Call& call) {
    FreedriveMode freedrive;
    if (call.given(0)) {
        freedrive.free_axes = call.vector6(0);
    }
    return call.applies(freedrive);
}

Value forceSensorInput(Call& call) {
    ForceSensorInput input;
    input.enable = call.boolean(0);
    input.mass = call.number(1, 0.0);
    input.offset = call.given(2) ? call.vector3(2) : input.offset;
    input.cog = call.given(3) ? call.vector3(3) : input.cog;
    return call.applies(input);
}

Value watchdog(Call& call) {
    RtdeWatchdog watchdog;
    watchdog.variable = call.string(0);
    watchdog.min_frequency = call.number(1);
    watchdog.action = inLowerCase(call.string(2, watchdog.action));
    if (call.ok() && watchdog.action != "ignore" && watchdog.action != "pause" &&
        watchdog.action != "stop") {
        return call.failed(Errc::invalid_argument,
                           "action '" + watchdog.action + "' is not ignore, pause or stop");
    }
    return call.applies(watchdog);
}

template <AnalogDomain::Port port>
Value analogDomain(Call& call) {
    return call.applies(AnalogDomain{port, call.integer(0), call.integer(1)});
}

Value other(Call& call) {
    const auto arguments = call.arguments();
    return call.applies(
        OtherCommand{std::string(call.name()), {arguments.begin(), arguments.end()}});
}

}  // namespace

std::span<const Builtin> settingBuiltins() {
    using Port = AnalogDomain::Port;
    static constexpr const char* kSensor = "enable sensor_mass sensor_measuring_offset sensor_cog";
    static constexpr Builtin kAll[] = {
        {"enable_external_ft_sensor", kSensor, 1, forceSensorInput},
        {"end_force_mode", "", 0, simple<EndForceMode>},
        {"end_freedrive_mode", "", 0, simple<EndFreedriveMode>},
        {"end_teach_mode", "", 0, simple<EndFreedriveMode>},
        {"force_mode", "task_frame selection_vector wrench type limits", 5, forceMode},
        {"force_mode_set_damping", "damping", 1,
         [](Call& call) { return call.applies(ForceModeDamping{call.number(0)}); }},
        {"force_mode_set_gain_scaling", "scaling", 1,
         [](Call& call) { return call.applies(ForceModeGainScaling{call.number(0)}); }},
        {"freedrive_mode", "freeAxes feature", 0, freedriveMode},
        {"ft_rtde_input_enable", kSensor, 1, forceSensorInput},
        {"position_deviation_warning", "enabled threshold", 1, other},
        {"powerdown", "", 0, simple<PowerDown>},
        {"protective_stop", "", 0, simple<ProtectiveStop>},
        {"reset_revolution_counter", "qNear", 0, other},
        {"rtde_set_watchdog", "variable_name min_frequency action", 2, watchdog},
        {"set_analog_inputrange", "port range", 2, analogDomain<Port::standard_input>},
        {"set_analog_outputdomain", "port domain", 2, analogDomain<Port::standard_output>},
        {"set_baselight", "color brightness", 0, other},
        {"set_configurable_digital_input_action", "port action", 2, other},
        {"set_gp_boolean_input_action", "port action", 2, other},
        {"set_gravity", "d", 1,
         [](Call& call) { return call.applies(SetGravity{call.vector3(0)}); }},
        {"set_input_actions_to_default", "", 0, other},
        {"set_payload", "m cog inertia", 1, setPayload},
        {"set_payload_cog", "CoG", 1, setPayloadCog},
        {"set_payload_mass", "m", 1, setPayloadMass},
        {"set_runstate_configurable_digital_output_to_value", "outputId state", 2, other},
        {"set_runstate_gp_boolean_output_to_value", "outputId state", 2, other},
        {"set_runstate_standard_analog_output_to_value", "outputId state", 2, other},
        {"set_runstate_standard_digital_output_to_value", "outputId state", 2, other},
        {"set_runstate_tool_digital_output_to_value", "outputId state", 2, other},
        {"set_safety_mode_transition_hardness", "type", 1, other},
        {"set_standard_analog_input_domain", "port domain", 2, analogDomain<Port::standard_input>},
        {"set_standard_digital_input_action", "port action", 2, other},
        {"set_target_payload", "m cog inertia transition_time", 1, setTargetPayload},
        {"set_tcp", "pose tcp_name", 1,
         [](Call& call) { return call.applies(SetTcp{call.pose(0)}); }},
        {"set_tool_analog_input_domain", "port domain", 2, analogDomain<Port::tool_input>},
        {"set_tool_communication", "enabled baud_rate parity stop_bits rx_idle_chars tx_idle_chars",
         6, other},
        {"set_tool_digital_input_action", "port action", 2, other},
        {"set_tool_digital_output_mode", "n mode", 2, other},
        {"set_tool_output_mode", "mode", 1, other},
        {"set_tool_voltage", "voltage", 1,
         [](Call& call) { return call.applies(SetToolVoltage{call.integer(0)}); }},
        {"teach_mode", "", 0, simple<FreedriveMode>},
        {"zero_ftsensor", "", 0, simple<ZeroForceSensor>},
    };
    return kAll;
}

}  // namespace metier::urscript
