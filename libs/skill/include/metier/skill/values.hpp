#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string_view>

#include "metier/base/error.hpp"
#include "metier/skill/value.hpp"

namespace metier::skill {

/// The inverse of skill::toJson(), for a field of that type. A frame may also be six numbers, a
/// vector three, a range two; a whole number is taken for any type of number that can hold it. null
/// is Null. Threads: any; pure. \param name of the field, for messages Errors: type_mismatch, with
/// the name, what is expected and what was given.
Result<skill::Value> valueFrom(const nlohmann::json& json, skill::ValueType type,
                               std::string_view name);

}  // namespace metier::skill
