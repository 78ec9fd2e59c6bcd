#pragma once

#include <string>
#include <string_view>

#include "metier/skill/value.hpp"

namespace metier::skill {

/// A value as JSON: frames {"x", "y", "z", "a", "b", "c"}, vectors {"x", "y", "z"}, ranges {"low",
/// "high"}; Null, and a number that is not finite, are null. Bytes of a text stay as they are.
std::string jsonOf(const Value& value);
/// An object with a member for each.
std::string jsonOf(const ValueMap& values);
/// A text with its quotes.
std::string jsonText(std::string_view text);

}  // namespace metier::skill
