#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string_view>

#include "metier/base/error.hpp"
#include "metier/skill/value.hpp"

namespace metier::skill {

/// Reads a value of the given type: the inverse of skill::toJson(). A frame may also be a list of
/// six numbers, a vector of three, a range of two. A whole number is taken for any type of number
/// that can hold it. null is Null.
/// \param name name of the field, for messages
/// Errors: type_mismatch, with the name, the expected type and what was given.
/// Threads: any; pure.
Result<skill::Value> valueFrom(const nlohmann::json& json, skill::ValueType type,
                               std::string_view name);

}  // namespace metier::skill
