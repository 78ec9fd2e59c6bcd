#pragma once

#include "metier/base/error.hpp"
#include "metier/opcua/value.hpp"
#include "metier/skill/field.hpp"
#include "node_role.hpp"

namespace metier::opcua_skill {

/// That part of a field's value, in the form in which it is sent; the empty value if there is none.
opcua::Value partOf(const skill::Value& value, Part part);

/// The field's value with one part replaced; parts that were never set are zero.
/// Errors: type_mismatch.
Result<skill::Value> withPart(const skill::Field& field, const skill::Value& old, Part part,
                              const opcua::Value& value);

}  // namespace metier::opcua_skill
