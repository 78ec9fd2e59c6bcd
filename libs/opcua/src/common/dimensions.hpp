#pragma once

#include <open62541/types.h>

namespace metier::opcua {

/// Whether every array in `data`, at any depth, has as many elements as its dimensions tell.
/// The stack decodes dimensions whose product overflows to the right number, and follows them
/// beyond the array (1.4.11) where it writes JSON; dimensions after an empty one cost it hours.
bool dimensionsFit(const void* data, const UA_DataType& type) noexcept;

}  // namespace metier::opcua
