#pragma once

#include "metier/base/error.hpp"
#include "metier/opcua/types.hpp"
#include "metier/opcua/value.hpp"
#include "metier/skill/field.hpp"
#include "metier/skill/value.hpp"

namespace metier::opcua_skill {

/// The value as it travels: a Frame as 3DFrame, a list as an array, Null as the empty value.
///
/// Threads: any; pure. The same holds for every function of this header.
opcua::Value toOpcua(const skill::Value& value);

/// What a peer wrote to, or told of, a field of that type. The empty value is Null.
/// Errors: type_mismatch, naming both types; numbers are not converted.
Result<skill::Value> fromOpcua(const opcua::Value& value, skill::ValueType type);

/// A value of which only the travelling form is known; `null` if skills have no such type.
skill::ValueType valueTypeOf(const opcua::Value& value);

/// The data type and the value rank (-1 scalar, 1 array) of a Variable that holds such values.
struct VariableShape {
    opcua::NodeId data_type;
    std::int32_t value_rank = -1;
    bool operator==(const VariableShape&) const = default;
};
VariableShape shapeOf(skill::ValueType type);

/// The inverse of shapeOf(); `null` if skills have no such type. Subtypes are for the caller.
skill::ValueType valueTypeOf(const VariableShape& shape);

/// The unit with its id of UNECE Recommendation 20 (OPC 10000-8, 5.6.3.3).
opcua::EuInformation toOpcua(const skill::Unit& unit);

/// The unit's symbol, for texts; empty for a plain number.
std::string symbolOf(const opcua::EuInformation& unit);

}  // namespace metier::opcua_skill
