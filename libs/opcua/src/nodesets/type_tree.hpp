#pragma once

#include <open62541/server.h>

#include <optional>
#include <unordered_map>

#include "metier/opcua/node_id.hpp"

namespace metier::opcua {

/// Types above types: among the nodes of a server, and in a NodeSet that is about to be loaded.
///
/// Threading: the server's own thread.
class TypeTree {
public:
    explicit TypeTree(UA_Server* server) : server_(server) {}

    /// Notes a type that is not a node yet.
    void note(const NodeId& type, const NodeId& above) { above_.insert_or_assign(type, above); }
    /// The type above a type; none for the topmost ones.
    std::optional<NodeId> above(const NodeId& type) const;
    /// Whether a type is another one or below it.
    bool isA(const NodeId& type, const NodeId& base) const;
    /// The id below the given one at the end of an inverse reference of a type; none without one.
    std::optional<NodeId> source(const NodeId& target, const NodeId& reference_type) const;

private:
    UA_Server* server_;
    mutable std::unordered_map<NodeId, NodeId> above_;  // null: nothing is above it
};

}  // namespace metier::opcua
