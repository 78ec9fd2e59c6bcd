#include "call.hpp"

namespace metier::urscript {
namespace {

constexpr int kStandardDigital = 8;       // then come the configurable ones
constexpr int kConfigurableDigital = 16;  // then come those of the tool
constexpr int kStandardAnalog = 2;        // then come those of the tool

template <typename Port>
struct Pin {
    Port port;
    int index;
};
using DigitalPin = Pin<DigitalPort>;
using AnalogPin = Pin<AnalogPort>;

/// The pin that a number means that counts all ports.
DigitalPin digitalPin(int n) {
    if (n >= kConfigurableDigital) {
        return {DigitalPort::tool, n - kConfigurableDigital};
    }
    return n >= kStandardDigital ? DigitalPin{DigitalPort::configurable, n - kStandardDigital}
                                 : DigitalPin{DigitalPort::standard, n};
}

AnalogPin analogPin(int n) {
    return n >= kStandardAnalog ? AnalogPin{AnalogPort::tool, n - kStandardAnalog}
                                : AnalogPin{AnalogPort::standard, n};
}

template <auto port>
Pin<decltype(port)> pinOf(int n) {
    return {port, n};
}

/// Returns the result of the robot's `function` for the pin whose number is the first argument.
template <auto pin_of, auto function>
Value getInput(Call& call) {
    const auto pin = pin_of(call.integer(0));
    return call.ok() ? call.checked((call.robot().*function)(pin.port, pin.index)) : Value();
}

template <auto pin_of>
Value setDigital(Call& call) {
    const DigitalPin pin = pin_of(call.integer(0));
    const bool value = call.boolean(1);
    return call.ok() ? call.checked(call.robot().setDigitalOutput(pin.port, pin.index, value))
                     : Value();
}

template <auto pin_of>
Value setAnalog(Call& call) {
    const AnalogPin pin = pin_of(call.integer(0));
    const double share = call.number(1);
    return call.ok() ? call.checked(call.robot().setAnalogOutput(pin.port, pin.index, share))
                     : Value();
}

}  // namespace

std::span<const Builtin> inputOutputBuiltins() {
    static constexpr auto kStandard = pinOf<DigitalPort::standard>;
    static constexpr auto kConfigurable = pinOf<DigitalPort::configurable>;
    static constexpr auto kTool = pinOf<DigitalPort::tool>;
    static constexpr auto kAnalog = pinOf<AnalogPort::standard>;
    static constexpr auto kToolAnalog = pinOf<AnalogPort::tool>;
    static constexpr auto kIn = &Robot::digitalInput;
    static constexpr auto kOut = &Robot::digitalOutput;
    static constexpr auto kAnalogIn = &Robot::analogInput;
    static constexpr auto kAnalogOut = &Robot::analogOutput;
    static constexpr Builtin kAll[] = {
        {"get_analog_in", "n", 1, getInput<analogPin, kAnalogIn>},
        {"get_analog_out", "n", 1, getInput<analogPin, kAnalogOut>},
        {"get_configurable_digital_in", "n", 1, getInput<kConfigurable, kIn>},
        {"get_configurable_digital_out", "n", 1, getInput<kConfigurable, kOut>},
        {"get_digital_in", "n", 1, getInput<digitalPin, kIn>},
        {"get_digital_out", "n", 1, getInput<digitalPin, kOut>},
        {"get_standard_analog_in", "n", 1, getInput<kAnalog, kAnalogIn>},
        {"get_standard_analog_out", "n", 1, getInput<kAnalog, kAnalogOut>},
        {"get_standard_digital_in", "n", 1, getInput<kStandard, kIn>},
        {"get_standard_digital_out", "n", 1, getInput<kStandard, kOut>},
        {"get_tool_analog_in", "n", 1, getInput<kToolAnalog, kAnalogIn>},
        {"get_tool_digital_in", "n", 1, getInput<kTool, kIn>},
        {"get_tool_digital_out", "n", 1, getInput<kTool, kOut>},
        {"set_analog_out", "n f", 2, setAnalog<analogPin>},
        {"set_configurable_digital_out", "n b", 2, setDigital<kConfigurable>},
        {"set_digital_out", "n b", 2, setDigital<digitalPin>},
        {"set_standard_analog_out", "n f", 2, setAnalog<kAnalog>},
        {"set_standard_digital_out", "n b", 2, setDigital<kStandard>},
        {"set_tool_digital_out", "n b", 2, setDigital<kTool>},
    };
    return kAll;
}

}  // namespace metier::urscript
