#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string_view>

#include "metier/base/error.hpp"
#include "metier/skill/value.hpp"

namespace metier::skill {

/// Reads a value of the given type: the inverse of skill::toJson(). A frame may also be a list of
/// six numbers, a vector of three, a range of two. A whole number is taken for any type of number
/// that can hold it, up to 2^53 if it is written with a fraction. null is Null. Units and limits of
/// a field are not known here: checkValue() looks at them.
/// \param type any but ValueType::null, for which only null is taken
/// \param name name of the field, for messages
/// Errors: type_mismatch, with the name, the expected type and the first 60 characters of what was
///         given; also for a number that is not finite, or that the type cannot hold.
/// Threads: any; pure.
Result<skill::Value> valueFrom(const nlohmann::json& json, skill::ValueType type,
                               std::string_view name);

}  // namespace metier::skill
