#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>

#include "metier/skill/value.hpp"

namespace metier::skill {

// Values of parameters and results as JSON: frames are {"x", "y", "z", "a", "b", "c"}, vectors
// {"x", "y", "z"}, ranges {"low", "high"}; Null is null; units are those of the field. Threads:
// any; pure.

nlohmann::json toJson(const Value& value);
/// An object with a member for each.
nlohmann::json toJson(const ValueMap& values);

/// The same as text without line breaks, members in the order above and numbers as short as they
/// can be: 1, not 1.0. A number that is not finite is null; what is no UTF-8 becomes U+FFFD.
std::string jsonOf(const Value& value);
std::string jsonOf(const ValueMap& values);
/// A text with its quotes.
std::string jsonText(std::string_view text);

}  // namespace metier::skill
