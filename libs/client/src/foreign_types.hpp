#pragma once

#include "metier/base/error.hpp"
#include "metier/opcua/types.hpp"
#include "metier/opcua/value.hpp"
#include "metier/skill/value.hpp"

namespace metier::client {

// Data types of namespace 0 that skills of other makers have, and skills of metier have not. A type
// that holds all their values stands for each.
// Threads: any; pure.

/// The type that stands for a data type: number for Float, int32 for SByte, Byte and Int16, uint32
/// for UInt16, text for LocalizedText. `null`: none does.
skill::ValueType standInFor(const opcua::NodeId& data_type);

/// Converts a value that a server has sent. The empty value is Null.
/// Errors: type_mismatch, naming both types.
Result<skill::Value> fromForeign(const opcua::Value& value, const opcua::NodeId& data_type);

/// Converts a value to the form in which it is sent. A LocalizedText gets no locale.
/// Errors: out_of_range, with the value and the limits; type_mismatch.
Result<opcua::Value> toForeign(const skill::Value& value, const opcua::NodeId& data_type);

}  // namespace metier::client
