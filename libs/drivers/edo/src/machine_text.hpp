#pragma once

#include <string>

#include "metier/device/arm.hpp"
#include "metier/edo_driver/messages.hpp"

namespace metier::edo_driver {

/// State and opcode in words: "BRAKED (brake active, collision)".
std::string toText(const MachineState& machine);

/// Safety state of the arm for a machine state; its text says what to do.
device::Safety safetyOf(const MachineState& machine);

}  // namespace metier::edo_driver
