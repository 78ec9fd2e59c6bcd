#pragma once

#include <open62541/plugin/nodestore.h>
#include <open62541/types_generated.h>

#include "nodesets/data_types.hpp"

namespace metier::opcua {

/// Stands in front of the stack's node store, for two things that the stack (1.4) gets wrong and
/// has no callback for.
///
/// It answers reads of the attribute DataTypeDefinition of enumerations, which the stack answers
/// for structures only. The stack asks its node store for the node, with a mask of attributes; in
/// 1.4 only the Read service and the sampling of MonitoredItems ask for this one, with the NodeId
/// of a ReadValueId. Until the stack gives the node back, this lends a Variable that has the
/// definition as its Value, and lets the request be one for the Value.
///
/// It gives the Call service no node that is no Method. The stack looks whether the Method is an
/// asynchronous one before it looks whether it is a Method at all, beyond the end of a smaller
/// node; what it finds there left such a call without an answer for two minutes.
///
/// Threading: the server's thread.
class NodeStoreFront {
public:
    explicit NodeStoreFront(const DataTypeStore& types);
    NodeStoreFront(const NodeStoreFront&) = delete;
    NodeStoreFront& operator=(const NodeStoreFront&) = delete;

    /// Stands in front of a node store; must outlive the server that has it. Once.
    void install(UA_Nodestore& store);

private:
    struct Front;

    const UA_Node* lend(const UA_NodeId& data_type);
    void takeBack() noexcept;

    const DataTypeStore& types_;
    UA_Nodestore behind_{};
    UA_Node stand_in_{};               ///< owns nothing
    UA_ReadValueId* asked_ = nullptr;  ///< request that is changed while the stand-in is lent
};

}  // namespace metier::opcua
