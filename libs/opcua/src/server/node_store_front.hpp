#pragma once

#include <open62541/plugin/nodestore.h>
#include <open62541/types_generated.h>

#include "nodesets/data_types.hpp"

namespace metier::opcua {

/// Answers reads of the attribute DataTypeDefinition of enumerations, which the stack (1.4) answers
/// for structures only.
///
/// The stack has no callback for reads of attributes other than Value. It asks its node store for
/// the node, with a mask of attributes; in 1.4 only the Read service and the sampling of
/// MonitoredItems ask for this one, with the NodeId of a ReadValueId. So this stands in front of
/// the node store. Until the stack gives the node back, it lends a Variable that has the definition
/// as its Value, and lets the request be one for the Value.
///
/// Threading: the server's thread.
class DefinitionReads {
public:
    explicit DefinitionReads(const DataTypeStore& types);
    DefinitionReads(const DefinitionReads&) = delete;
    DefinitionReads& operator=(const DefinitionReads&) = delete;

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
