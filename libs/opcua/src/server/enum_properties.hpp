#pragma once

#include "metier/opcua/address_space.hpp"
#include "nodesets/data_types.hpp"

namespace metier::opcua {

/// Notes definitions of all enumerations of a server that have none yet, made of their Properties
/// EnumStrings or EnumValues. An enumeration without these stays without a definition.
/// Threads: those of AddressSpace. Errors: internal (the stack).
Result<> defineByProperties(const AddressSpace& nodes, DataTypeStore& store);

}  // namespace metier::opcua
