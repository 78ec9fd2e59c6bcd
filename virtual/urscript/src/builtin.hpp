#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "metier/urscript/value.hpp"

namespace metier::urscript {

class Call;

/// One function that the controller has. Parameters without an argument are none in the call.
struct Builtin {
    std::string_view name;
    std::string_view parameters;  ///< names, separated by blanks
    std::uint8_t required = 0;    ///< number of parameters without a default value
    /// Its return value is used if the call neither failed nor waits.
    Value (*function)(Call& call) = nullptr;
};

/// nullptr if the controller has none of that name.
const Builtin* findBuiltin(std::string_view name);

// The groups of functions, each in its own file.
std::span<const Builtin> mathBuiltins();
std::span<const Builtin> poseBuiltins();
std::span<const Builtin> textBuiltins();
std::span<const Builtin> listBuiltins();
std::span<const Builtin> stateBuiltins();
std::span<const Builtin> motionBuiltins();
std::span<const Builtin> settingBuiltins();
std::span<const Builtin> registerBuiltins();
std::span<const Builtin> inputOutputBuiltins();
std::span<const Builtin> socketBuiltins();
std::span<const Builtin> programBuiltins();

}  // namespace metier::urscript
