#pragma once

#include <open62541/server.h>

#include <string>
#include <unordered_map>
#include <vector>

#include "metier/opcua/node_id.hpp"
#include "metier/opcua/types.hpp"
#include "nodesets/data_types.hpp"
#include "nodesets/nodeset_file.hpp"
#include "nodesets/nodeset_ids.hpp"
#include "nodesets/type_tree.hpp"

namespace metier::opcua {

/// A reference from or to a node of a NodeSet file.
struct ReferenceElement {
    NodeId type;
    NodeId target;
    bool forward = true;
    pugi::xml_node element;
};

/// A node of a NodeSet file, with the ids of the server.
struct NodeElement {
    UA_NodeClass node_class = UA_NODECLASS_UNSPECIFIED;
    NodeId id{};
    QualifiedName name{};
    pugi::xml_node element{};
    std::vector<ReferenceElement> references{};  ///< without the three that follow
    NodeId parent{};                             ///< null: it has none
    NodeId parent_reference{};
    NodeId type_definition{};  ///< of Objects and Variables
    bool is_instance = true;   ///< not below a type of the file
};

/// The nodes of a NodeSet file, read but not added.
struct NodeElements {
    std::vector<NodeElement> nodes;
    std::unordered_map<NodeId, std::size_t> index;  ///< of `nodes`
    /// Data types by the ids of their encodings.
    std::unordered_map<NodeId, NodeId> encoded_types;
    std::vector<DataTypeElement> data_types;
};

/// Lines "file:line: why" of a file that cannot be loaded, and of what was left out of it.
class NodesetProblems {
public:
    explicit NodesetProblems(const NodesetFile& file) : file_(file) {}
    void add(const pugi::xml_node& element, std::string_view why);
    bool empty() const noexcept { return count_ == 0; }
    /// The first ones, and the number of the others.
    Error error() const;

private:
    const NodesetFile& file_;
    std::size_t count_ = 0;
    std::string lines_;
};

/// Reads the nodes of a file and notes its types in the tree. What is wrong is added to the
/// problems.
NodeElements readNodes(const NodesetFile& file, const NodesetIds& ids, TypeTree& tree,
                       NodesetProblems& problems);

}  // namespace metier::opcua
