#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "metier/skill/value.hpp"

namespace metier::skill {

// Values of parameters and results as JSON: frames are {"x", "y", "z", "a", "b", "c"}, vectors
// {"x", "y", "z"}, ranges {"low", "high"}; Null is null; units are those of the field. Threads:
// any; pure.

nlohmann::json toJson(const Value& value);
/// An object with a member for each value.
nlohmann::json toJson(const ValueMap& values);

/// The same as text without line breaks. Members have the order above; numbers are as short as
/// possible: 1, not 1.0. A number that is not finite becomes null, a byte that is not UTF-8 becomes
/// U+FFFD.
std::string jsonOf(const Value& value);
std::string jsonOf(const ValueMap& values);

}  // namespace metier::skill
