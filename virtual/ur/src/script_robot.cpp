#include "script_robot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace metier::virtual_ur {

namespace {

// A force on the tool beyond it is a contact [N].
constexpr double kContact = 5.0;

using urscript::AnalogPort;
using urscript::DigitalPort;
using urscript::Pose;
using urscript::RegisterBank;

/// First bit of a digital port, and the number of its bits.
struct BitRange {
    std::size_t first = 0;
    int count = 8;
};

// By DigitalPort: standard, configurable, tool.
constexpr std::array kBits{BitRange{0, 8}, BitRange{8, 8}, BitRange{16, 2}};

Result<std::size_t> within(int index, std::size_t count, std::string_view what) {
    if (index < 0 || static_cast<std::size_t>(index) >= count) {
        return fail(Errc::out_of_range,
                    fmt::format("{} {} is not within 0 to {}", what, index, count - 1));
    }
    return static_cast<std::size_t>(index);
}

template <typename Values>
auto read(const Values& values, int index, std::string_view what) {
    return within(index, values.size(), what).map([&](std::size_t i) { return values[i]; });
}

template <typename Values, typename Value>
Result<void> write(Values& values, int index, Value value, std::string_view what) {
    return within(index, values.size(), what).map([&](std::size_t i) { values[i] = value; });
}

Result<std::uint64_t> bitOf(DigitalPort port, int index) {
    const auto& range = kBits.at(static_cast<std::size_t>(port));
    return within(index, static_cast<std::size_t>(range.count), "digital port")
        .map([&](std::size_t i) { return std::uint64_t{1} << (range.first + i); });
}

/// Takes what needs no more than the robot's state.
struct StateSetter {
    RobotState& state;

    void operator()(const urscript::SetPayload& payload) const {
        state.payload = payload.mass;
        state.payload_cog = payload.cog.value_or(state.payload_cog);
        state.payload_inertia = payload.inertia.value_or(state.payload_inertia);
    }
    void operator()(const urscript::SetTargetPayload& payload) const {
        (*this)(static_cast<const urscript::SetPayload&>(payload));  // at once
    }
    void operator()(const urscript::SetGravity& gravity) const { state.gravity = gravity.gravity; }
    void operator()(const urscript::SetToolVoltage& tool) const {
        state.io.tool_voltage = tool.voltage;
    }
    void operator()(const urscript::ZeroForceSensor&) const {
        for (std::size_t i = 0; i < kAxes; ++i) {
            state.force_bias[i] += state.actual_tcp_force[i];
        }
    }
    void operator()(const urscript::AnalogDomain& domain) const {
        if (domain.index < 0 || domain.index > 1) {
            return;
        }
        const auto index = static_cast<std::size_t>(domain.index);
        const auto value = static_cast<std::uint8_t>(domain.domain != 0);
        // By AnalogDomain::Port: standard input, standard output, tool input.
        constexpr std::array kDomains{&InputsOutputs::analog_input_domains,
                                      &InputsOutputs::analog_output_domains,
                                      &InputsOutputs::tool_analog_input_domains};
        (state.io.*kDomains.at(static_cast<std::size_t>(domain.port)))[index] = value;
    }
    // Force control and freedrive of an arm that touches nothing: it stays where it is.
    template <typename Other>
    void operator()(const Other&) const {}
};

}  // namespace

ScriptRobot::ScriptRobot(Parts parts) : parts_(std::move(parts)) {}

void ScriptRobot::beginCycle() {
    const auto& state = parts_.state;
    seen_.actual_joint_position = state.actual_q;
    seen_.target_joint_position = parts_.arm.target().position;
    seen_.actual_joint_velocity = state.actual_qd;
    seen_.target_joint_velocity = parts_.arm.target().velocity;
    seen_.joint_temperature = state.joint_temperature;
    seen_.actual_tool_pose = Pose{state.actual_tcp_pose};
    seen_.target_tool_pose = Pose{state.target_tcp_pose};
    seen_.actual_twist = state.actual_tcp_speed;
    seen_.target_twist = state.target_tcp_speed;
    seen_.wrench = state.actual_tcp_force;
    seen_.flange_from_tool = Pose{state.tcp_offset};
    seen_.payload_mass = state.payload;
    seen_.payload_cog = state.payload_cog;
    seen_.payload_inertia = state.payload_inertia;
    seen_.time = state.timestamp;
    seen_.steady = parts_.arm.standing();

    const auto& force = state.actual_tcp_force;
    if (std::hypot(force[0], force[1], force[2]) < kContact) {
        contact_since_ = 0;
    } else if (contact_since_ == 0) {
        contact_since_ = state.cycle;
    }
}

int ScriptRobot::toolContact(const Vector6& direction) const {
    if (contact_since_ == 0) {
        return 0;
    }
    double against = 0.0;  // the force pushes back
    double length = 0.0;
    for (std::size_t i = 0; i < 3; ++i) {
        against -= direction[i] * parts_.state.actual_tcp_force[i];
        length += std::abs(direction[i]);
    }
    const bool touched = length == 0.0 || against > 0.0;
    return touched ? static_cast<int>(parts_.state.cycle - contact_since_ + 1) : 0;
}

void ScriptRobot::setTool(const motion::Pose& flange_from_tool) {
    parts_.arm.setTool(flange_from_tool);
    parts_.state.tcp_offset = toVector(flange_from_tool);
}

Result<void> ScriptRobot::apply(const urscript::Command& command) {
    if (const auto* tool = std::get_if<urscript::SetTcp>(&command)) {
        setTool(toPose(tool->flange_from_tool.value));
    } else if (const auto* watchdog = std::get_if<urscript::RtdeWatchdog>(&command)) {
        if (watchdog->min_frequency > 0.0) {
            watchdogs_[watchdog->variable] = {1.0 / watchdog->min_frequency, 0.0, watchdog->action};
        } else {
            watchdogs_.erase(watchdog->variable);
        }
    } else if (std::holds_alternative<urscript::PowerDown>(command)) {
        parts_.power_down();
    } else if (std::holds_alternative<urscript::ProtectiveStop>(command)) {
        parts_.protective_stop();
    } else {
        std::visit(StateSetter{parts_.state}, command);
    }
    return {};
}

void ScriptRobot::inputsWritten(const std::vector<std::string>& names) {
    for (auto& [variable, watchdog] : watchdogs_) {
        if (std::find(names.begin(), names.end(), variable) != names.end()) {
            watchdog.silent = 0.0;
        }
    }
}

std::string ScriptRobot::watch() {
    std::string wanted;
    for (auto& [variable, watchdog] : watchdogs_) {
        watchdog.silent += parts_.cycle;
        if (watchdog.silent > watchdog.period && watchdog.action != "ignore" && wanted != "stop") {
            wanted = watchdog.action == "stop" ? "stop" : "pause";
        }
    }
    return wanted;
}

void ScriptRobot::endProgram() {
    parts_.sockets.closeAll();
    watchdogs_.clear();
    motion_.reset();
    popup_open_ = false;
}

void ScriptRobot::showPopup(const urscript::Popup& popup) {
    popup_open_ = true;
    parts_.popup(popup);
}

const Registers& ScriptRobot::bank(RegisterBank which) const {
    return which == RegisterBank::input ? parts_.state.inputs : parts_.state.outputs;
}

Result<std::int32_t> ScriptRobot::integerRegister(RegisterBank which, int index) const {
    return read(bank(which).integers, index, "integer register");
}

Result<double> ScriptRobot::floatRegister(RegisterBank which, int index) const {
    return read(bank(which).numbers, index, "float register");
}

Result<bool> ScriptRobot::bitRegister(RegisterBank which, int index) const {
    return read(bank(which).bits, index, "boolean register");
}

Result<void> ScriptRobot::writeIntegerRegister(int index, std::int32_t value) {
    return write(parts_.state.outputs.integers, index, value, "integer register");
}

Result<void> ScriptRobot::writeFloatRegister(int index, double value) {
    return write(parts_.state.outputs.numbers, index, value, "float register");
}

Result<void> ScriptRobot::writeBitRegister(int index, bool value) {
    return write(parts_.state.outputs.bits, index, value, "boolean register");
}

Result<bool> ScriptRobot::digitalInput(DigitalPort port, int index) const {
    return bitOf(port, index).map([&](std::uint64_t bit) {
        return (parts_.state.io.digital_inputs & bit) != 0;
    });
}

Result<bool> ScriptRobot::digitalOutput(DigitalPort port, int index) const {
    return bitOf(port, index).map([&](std::uint64_t bit) {
        return (parts_.state.io.digital_outputs & bit) != 0;
    });
}

Result<void> ScriptRobot::setDigitalOutput(DigitalPort port, int index, bool value) {
    return bitOf(port, index).map([&](std::uint64_t bit) {
        auto& outputs = parts_.state.io.digital_outputs;
        outputs = value ? outputs | bit : outputs & ~bit;
    });
}

Result<double> ScriptRobot::analogInput(AnalogPort port, int index) const {
    const auto& io = parts_.state.io;
    const auto& inputs = port == AnalogPort::tool ? io.tool_analog_inputs : io.analog_inputs;
    return read(inputs, index, "analog input");
}

namespace {

// Values of the shares 0 and 1: 4 and 20 mA, or 0 and 10 V.
constexpr double kLeastCurrent = 0.004;
constexpr double kCurrentRange = 0.016;
constexpr double kVoltageRange = 10.0;

}  // namespace

Result<double> ScriptRobot::analogOutput(AnalogPort, int index) const {
    const auto& io = parts_.state.io;
    return within(index, io.analog_outputs.size(), "analog output").map([&](std::size_t i) {
        return io.analog_output_domains[i] != 0
                   ? io.analog_outputs[i] / kVoltageRange
                   : std::max(0.0, io.analog_outputs[i] - kLeastCurrent) / kCurrentRange;
    });
}

Result<void> ScriptRobot::setAnalogOutput(AnalogPort, int index, double share) {
    auto& io = parts_.state.io;
    return within(index, io.analog_outputs.size(), "analog output").map([&](std::size_t i) {
        const double part = std::clamp(share, 0.0, 1.0);
        io.analog_outputs[i] = io.analog_output_domains[i] != 0
                                   ? part * kVoltageRange
                                   : kLeastCurrent + part * kCurrentRange;
    });
}

}  // namespace metier::virtual_ur
