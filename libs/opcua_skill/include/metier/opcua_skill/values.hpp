#pragma once

#include "metier/base/error.hpp"
#include "metier/opcua/address_space.hpp"
#include "metier/opcua/types.hpp"
#include "metier/opcua/value.hpp"
#include "metier/skill/field.hpp"
#include "metier/skill/value.hpp"

namespace metier::opcua_skill {

/// Converts a value to the form in which it is sent: a Frame to a 3DFrame, a list to an array, Null
/// to the empty value.
///
/// Threads: any; pure. That holds for every function of this header.
opcua::Value toOpcua(const skill::Value& value);

/// Converts a value that a peer wrote or returned to the type of a field. The empty value is Null.
/// Errors: type_mismatch, naming both types; numbers are not converted.
Result<skill::Value> fromOpcua(const opcua::Value& value, skill::ValueType type);

/// Type of a value whose field is not known; `null` if skills have no such type, or if it is empty.
skill::ValueType valueTypeOf(const opcua::Value& value);

/// Data type, value rank (-1 scalar, 1 array) and dimensions of the Variable for a type of value.
opcua::VariableShape shapeOf(skill::ValueType type);

/// Inverse of shapeOf(), whatever the dimensions; `null` if skills have no such type. The caller
/// resolves subtypes.
skill::ValueType valueTypeOf(const opcua::VariableShape& shape);

/// Converts a unit, with its id of UNECE Recommendation 20 (OPC 10000-8, 5.6.3.3).
opcua::EuInformation toOpcua(const skill::Unit& unit);

/// Symbol of the unit, for messages; empty for a plain number.
std::string symbolOf(const opcua::EuInformation& unit);

}  // namespace metier::opcua_skill
