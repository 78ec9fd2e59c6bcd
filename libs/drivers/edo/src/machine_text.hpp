#pragma once

#include <string>

#include "metier/device/arm.hpp"
#include "metier/edo_driver/messages.hpp"

namespace metier::edo_driver {

/// The state's name, as "CALIBRATED"; "state 42" if it is not known.
std::string stateName(std::uint8_t state);

/// The bits of the opcode in words, separated by commas; empty if there are none.
std::string opcodeText(std::uint32_t opcode);

/// State and opcode in words: "BRAKED (brake active, collision)".
std::string toText(const MachineState& machine);

/// Safety state of the arm for a machine state; its text says what to do.
device::Safety safetyOf(const MachineState& machine);

}  // namespace metier::edo_driver
