#pragma once

#include <string_view>

#include "metier/base/error.hpp"
#include "metier/skill/value.hpp"

namespace metier::app {

/// A parameter value from the command line.
///
/// Numbers are separated by commas: a frame is `x,y,z,a,b,c`, a list `0.1,0.2`, ranges are
/// `low:high,low:high`, frames in a list are separated by semicolons; `null` asks for the default.
/// Errors: invalid_argument, with what was given and what was expected.
Result<skill::Value> parseValue(skill::ValueType type, std::string_view text);

/// Notation of a value of that type, for help: "x,y,z,a,b,c".
std::string_view notation(skill::ValueType type) noexcept;

}  // namespace metier::app
