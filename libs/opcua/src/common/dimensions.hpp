#pragma once

#include <open62541/types.h>

namespace metier::opcua {

/// Whether every array in `data`, at any depth, has as many elements as its dimensions say. The
/// stack (1.4.11) accepts dimensions whose product overflows to the right number, and reads beyond
/// the array when it writes JSON; dimensions after an empty one cost it hours.
bool dimensionsFit(const void* data, const UA_DataType& type) noexcept;

}  // namespace metier::opcua
