#pragma once

#include <open62541/server.h>

#include <string>

#include "metier/base/error.hpp"
#include "nodesets/node_elements.hpp"
#include "nodesets/xml_values.hpp"

namespace metier::opcua {

/// Adds single nodes of a NodeSet file to a server.
///
/// Threading: the server's own thread.
class NodeAdder {
public:
    /// What the nodes of a file need; must outlive this.
    struct Context {
        UA_Server* server;
        const NodesetIds& ids;
        const TypeTree& tree;
        const XmlValues& values;
    };
    explicit NodeAdder(const Context& context) : context_(context) {}

    /// Adds a node with its attributes, its value, its type and the reference from its parent.
    Read add(const NodeElement& node) const;

private:
    template <typename Attributes>
    Attributes described(const NodeElement& node, Attributes attributes) const;
    template <typename Attributes>
    Read readShape(const NodeElement& node, Attributes& attributes) const;
    Read checkValue(const NodeElement& node, const UA_Variant& value, const NodeId& data_type,
                    std::int32_t rank) const;
    bool holds(const NodeId& data_type, const UA_DataType& type) const;
    template <typename Attributes>
    Read begin(const NodeElement& node, const Attributes& attributes,
               std::size_t attributes_type) const;
    template <typename Attributes>
    Read addValued(const NodeElement& node, const Attributes& preset,
                   std::size_t attributes_type) const;
    Read addVariable(const NodeElement& node) const;
    Read finish(const NodeElement& node) const;

    const Context context_;
};

}  // namespace metier::opcua
