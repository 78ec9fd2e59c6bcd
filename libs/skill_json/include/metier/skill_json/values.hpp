#pragma once

#include <nlohmann/json.hpp>
#include <string_view>

#include "metier/base/error.hpp"
#include "metier/skill/value.hpp"

namespace metier::skill_json {

// Values of parameters and results as JSON. Threads: any; pure.

/// A value as JSON: frames and vectors as objects of numbers, such as {"x": 0.1, ...}, ranges as
/// {"low": .., "high": ..}, Null as null; units are those of the field.
nlohmann::json toJson(const skill::Value& value);
nlohmann::json toJson(const skill::ValueMap& values);

/// The inverse, for a field of that type. A frame may also be six numbers, a vector three, a range
/// two; a whole number is taken for any type of number that can hold it. null is Null.
/// \param name of the field, for messages
/// Errors: type_mismatch, with the name, what is expected and what was given.
Result<skill::Value> valueFrom(const nlohmann::json& json, skill::ValueType type,
                               std::string_view name);

}  // namespace metier::skill_json
