#pragma once

#include <open62541/server.h>

#include "metier/opcua/address_space.hpp"

namespace metier::opcua {

/// Makes every field that an event type inherits selectable by that type (OPC 10000-4, 7.4.4.5).
/// For once, when all types are loaded.
///
/// The stack (1.4) takes a select clause if its type or one below has the field, and never looks at
/// the types above. So each event type gets the types above it as subtypes on another server: the
/// stack follows such a reference without asking for the server, and Browse leaves it out.
/// Threading: the server's thread, or before the server's start.
/// Errors: internal (the stack).
Result<> inheritEventFields(UA_Server* server, const AddressSpace& nodes);

/// Adds a Variable for each field of any event type, out of sight of clients. For once, when all
/// types are loaded.
Result<> addAbsentFields(AddressSpace& nodes);

/// Gives an event's node all fields of other event types, without a value.
///
/// The stack (1.4) clears memory that it never set if an operand of a where clause names a field
/// that the event lacks, and crashes if the second operand of a comparison is Null. So such a field
/// is an array of no length: no comparison with it is true, and clients show null.
Result<> completeFields(AddressSpace& nodes, const NodeId& event);

}  // namespace metier::opcua
