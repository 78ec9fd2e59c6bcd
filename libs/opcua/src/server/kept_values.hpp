#pragma once

#include <open62541/server.h>

#include "common/convert.hpp"
#include "metier/opcua/node_id.hpp"

namespace metier::opcua {

class ServerCore;

/// Value of a Variable that no program serves, kept here and not in the stack's node.
///
/// The stack (1.4) stores any StatusCode and any time that a client writes to a value of its own.
/// Here such a write is refused with BadWriteNotSupported, unless the AccessLevel has StatusWrite
/// or TimestampWrite (OPC 10000-3, 8.57; OPC 10000-4, 5.11.4).
struct KeptValue {
    Owned<UA_DataValue> value{UA_TYPES[UA_TYPES_DATAVALUE]};
};

/// Place where the value of a Variable is kept.
enum class Storage {
    /// Another part of the server answers for it, or clients cannot write it.
    elsewhere,
    /// Its value is kept here from now on.
    kept,
    /// A type declares it: no client may write it, since instances begin with its value.
    declared,
};

/// Takes the value of a Variable out of the stack's node, if the stack would store what clients
/// write there. Until then nothing changes for those who read, and the server's own writes may
/// have any status and time.
/// Threading: the server's thread. Exceptions: std::bad_alloc.
Storage keepValueOf(ServerCore& core, const NodeId& variable);

}  // namespace metier::opcua
