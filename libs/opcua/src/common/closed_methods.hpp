#pragma once

#include <open62541/server.h>

namespace metier::opcua {

/// Closes a Method that has no work: its Executable is false, and a call gets BadNotExecutable.
/// A Method without any callback would get BadInternalError from the stack (1.4), which looks for
/// the callback before it looks at Executable.
UA_StatusCode closeMethod(UA_Server* server, const UA_NodeId& method);

/// Gives a Method work, and with it Executable.
UA_StatusCode openMethod(UA_Server* server, const UA_NodeId& method, UA_MethodCallback work);

/// Closes all Methods of a server that have no work: types declare them, and nothing implements
/// them. The stack's NodeSet compiler makes every Method executable.
UA_StatusCode closeIdleMethods(UA_Server* server);

}  // namespace metier::opcua
