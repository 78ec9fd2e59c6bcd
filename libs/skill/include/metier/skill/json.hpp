#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "metier/skill/value.hpp"

namespace metier::skill {

// Values of parameters and results as JSON: frames are {"x", "y", "z", "a", "b", "c"}, vectors
// {"x", "y", "z"}, ranges {"low", "high"}; Null is null; units are those of the field. valueFrom()
// of values.hpp reads them back. Threads: any; pure.

/// One value. Members of an object come in the order of the alphabet.
nlohmann::json toJson(const Value& value);
/// An object with a member for each value.
nlohmann::json toJson(const ValueMap& values);

/// The same as text without line breaks. Members have the order above; whole numbers below 1e15 are
/// written without a fraction: 1, not 1.0. A number that is not finite becomes null, a byte that is
/// not UTF-8 becomes U+FFFD.
std::string jsonOf(const Value& value);
/// An object as text; its members come in the order of their names.
std::string jsonOf(const ValueMap& values);

}  // namespace metier::skill
