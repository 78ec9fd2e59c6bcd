#include "machine_text.hpp"

#include <fmt/format.h>

#include <array>
#include <string_view>

namespace metier::edo_driver {
namespace {

using device::SafetyState;

constexpr std::array<std::string_view, 10> kBits{"a joint does not answer",
                                                 "a joint is absent",
                                                 "overcurrent",
                                                 "a joint is not calibrated",
                                                 "position error",
                                                 "joint bus error",
                                                 "brake active",
                                                 "emergency stop",
                                                 "fence open",
                                                 "collision"};

constexpr std::array<std::string_view, 9> kNames{
    "INIT",  "NOT_CALIBRATED", "CALIBRATED",   "MOVE",     "JOG",
    "ERROR", "BRAKED",         "BRAKES_CHECK", "MOVE_TEST"};

constexpr std::uint32_t kNeedsAPerson = MachineState::no_ack | MachineState::joint_absent |
                                        MachineState::overcurrent | MachineState::position_error |
                                        MachineState::bus_error;

constexpr std::string_view kCalibrate =
    "a person must move each axis to its notch and calibrate the robot";

SafetyState stopKind(std::uint32_t opcode) {
    return (opcode & MachineState::emergency_stop) != 0 ? SafetyState::emergency_stop
                                                        : SafetyState::protective_stop;
}

std::string stateName(std::uint8_t state) {
    if (state == MachineState::command) {
        return "COMMAND";
    }
    return state < kNames.size() ? std::string(kNames[state]) : fmt::format("state {}", state);
}

std::string opcodeText(std::uint32_t opcode) {
    std::string text;
    for (std::uint32_t bit = 0; bit < 32; ++bit) {
        if ((opcode >> bit & 1U) != 0) {
            text += text.empty() ? "" : ", ";
            text += bit < kBits.size() ? std::string(kBits[bit]) : fmt::format("bit {}", bit);
        }
    }
    return text;
}

device::Safety unusable(SafetyState state, const MachineState& machine, std::string_view advice) {
    return {state, fmt::format("{}{}{}", toText(machine), advice.empty() ? "" : ": ", advice)};
}

/// Safety by the opcode, for a machine state in which the arm could move.
device::Safety byOpcode(const MachineState& machine) {
    if (machine.opcode == 0) {
        return {};
    }
    if ((machine.opcode & kNeedsAPerson) != 0) {
        return unusable(SafetyState::fault, machine, "");
    }
    if ((machine.opcode & MachineState::uncalibrated) != 0) {
        return unusable(SafetyState::fault, machine, kCalibrate);
    }
    return unusable(stopKind(machine.opcode), machine, "");
}

}  // namespace

std::string toText(const MachineState& machine) {
    const auto bits = opcodeText(machine.opcode);
    return bits.empty() ? stateName(machine.state)
                        : fmt::format("{} ({})", stateName(machine.state), bits);
}

device::Safety safetyOf(const MachineState& machine) {
    switch (machine.state) {
        case MachineState::init:
            return unusable(SafetyState::protective_stop, machine,
                            "not started; a reset starts it and releases the brakes");
        case MachineState::not_calibrated:
            return unusable(SafetyState::fault, machine, kCalibrate);
        case MachineState::calibrated:
        case MachineState::move:
        case MachineState::jog:
            return byOpcode(machine);
        case MachineState::error:
            return unusable(SafetyState::fault, machine, "the robot must be restarted");
        case MachineState::braked:
            return unusable(stopKind(machine.opcode), machine, "a reset releases the brakes");
        default:
            return unusable(stopKind(machine.opcode), machine, "");
    }
}

}  // namespace metier::edo_driver
