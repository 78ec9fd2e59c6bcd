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

}  // namespace metier::opcua
