#include "nodesets/node_elements.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>
#include <utility>

#include "metier/opcua/standard_ids.hpp"
#include "metier/opcua/text.hpp"

namespace metier::opcua {

namespace {

constexpr std::size_t kMostProblems = 20;

struct ElementClass {
    std::string_view name;
    UA_NodeClass node_class;
};

constexpr std::array kElementClasses{
    ElementClass{"UAObject", UA_NODECLASS_OBJECT},
    ElementClass{"UAVariable", UA_NODECLASS_VARIABLE},
    ElementClass{"UAMethod", UA_NODECLASS_METHOD},
    ElementClass{"UAObjectType", UA_NODECLASS_OBJECTTYPE},
    ElementClass{"UAVariableType", UA_NODECLASS_VARIABLETYPE},
    ElementClass{"UADataType", UA_NODECLASS_DATATYPE},
    ElementClass{"UAReferenceType", UA_NODECLASS_REFERENCETYPE},
    ElementClass{"UAView", UA_NODECLASS_VIEW},
};

/// Unspecified for other elements, such as Models and Aliases.
UA_NodeClass classOf(const pugi::xml_node& element) {
    const auto name = localName(element);
    const auto* const found =
        std::find_if(kElementClasses.begin(), kElementClasses.end(),
                     [name](const ElementClass& each) { return each.name == name; });
    return found == kElementClasses.end() ? UA_NODECLASS_UNSPECIFIED : found->node_class;
}

bool isInstance(UA_NodeClass node_class) {
    return node_class == UA_NODECLASS_OBJECT || node_class == UA_NODECLASS_VARIABLE;
}

class NodeReading {
public:
    NodeReading(const NodesetFile& file, const NodesetIds& ids, TypeTree& tree,
                NodesetProblems& problems)
        : file_(file), ids_(ids), tree_(tree), problems_(problems) {}

    NodeElements read() {
        for (const auto& element : file_.root().children()) {
            if (const auto node_class = classOf(element); node_class != UA_NODECLASS_UNSPECIFIED) {
                readNode(element, node_class);
            }
        }
        noteTypes();
        noteEncodings();
        findParents();
        return std::move(all_);
    }

private:
    void readNode(const pugi::xml_node& element, UA_NodeClass node_class) {
        const auto id = ids_.nodeId(element.attribute("NodeId").value());
        const auto name = ids_.name(element.attribute("BrowseName").value());
        if (!id || !name) {
            problems_.add(element, id ? "BrowseName: " + name.error().message
                                      : "NodeId: " + id.error().message);
            return;
        }
        const auto [first, is_new] = all_.index.emplace(*id, all_.nodes.size());
        if (!is_new) {
            problems_.add(element, fmt::format("the NodeId {} is taken in line {}",
                                               sanitise(element.attribute("NodeId").value()),
                                               file_.lineOf(all_.nodes[first->second].element)));
            return;
        }
        NodeElement node{.node_class = node_class, .id = *id, .name = *name, .element = element};
        for (const auto& reference : childNamed(element, "References").children()) {
            if (reference.type() == pugi::node_element) {
                readReference(reference, node);
            }
        }
        all_.nodes.push_back(std::move(node));
    }

    void readReference(const pugi::xml_node& element, NodeElement& node) {
        const auto type = ids_.nodeId(element.attribute("ReferenceType").value());
        const auto target = ids_.nodeId(textIn(element));
        if (!type || !target) {
            problems_.add(element, (type ? target : type).error().message);
            return;
        }
        const bool forward = element.attribute("IsForward").as_bool(true);
        if (forward && *type == ids::kHasTypeDefinition) {
            node.type_definition = *target;
        } else {
            node.references.push_back({*type, *target, forward, element});
        }
    }

    void noteTypes() {
        for (const auto& node : all_.nodes) {
            for (const auto& reference : node.references) {
                if (reference.type != ids::kHasSubtype) {
                    continue;
                }
                if (reference.forward) {
                    tree_.note(reference.target, node.id);
                } else {
                    tree_.note(node.id, reference.target);
                }
            }
        }
    }

    void noteEncodings() {
        std::unordered_map<NodeId, NodeId> binary;  // of a data type
        const auto note = [&](const NodeId& type, const NodeId& encoding) {
            all_.encoded_types.insert_or_assign(encoding, type);
            const auto node = all_.index.find(encoding);
            if (node != all_.index.end() &&
                all_.nodes[node->second].name.name == "Default Binary") {
                binary.insert_or_assign(type, encoding);
            }
        };
        for (const auto& node : all_.nodes) {
            for (const auto& reference : node.references) {
                if (reference.type == ids::kHasEncoding) {
                    note(reference.forward ? node.id : reference.target,
                         reference.forward ? reference.target : node.id);
                }
            }
        }
        for (const auto& node : all_.nodes) {
            if (node.node_class == UA_NODECLASS_DATATYPE) {
                const auto encoding = binary.find(node.id);
                all_.data_types.push_back({node.id,
                                           encoding == binary.end() ? NodeId() : encoding->second,
                                           node.element});
            }
        }
    }

    bool isHierarchical(const NodeId& reference_type) {
        const auto known = hierarchical_.find(reference_type);
        return known != hierarchical_.end()
                   ? known->second
                   : hierarchical_
                         .emplace(reference_type,
                                  tree_.isA(reference_type, ids::kHierarchicalReferences))
                         .first->second;
    }

    /// The reference from above of a node's own; that from the ParentNodeId, if there are several.
    void findOwnParent(NodeElement& node) {
        const auto wanted = ids_.nodeId(node.element.attribute("ParentNodeId").as_string("i=0"));
        const auto is_parent = [&](const ReferenceElement& reference) {
            return !reference.forward && isHierarchical(reference.type);
        };
        auto found = std::find_if(node.references.begin(), node.references.end(),
                                  [&](const ReferenceElement& reference) {
                                      return is_parent(reference) && reference.target == *wanted;
                                  });
        if (found == node.references.end()) {
            found = std::find_if(node.references.begin(), node.references.end(), is_parent);
        }
        if (found != node.references.end()) {
            node.parent = found->target;
            node.parent_reference = found->type;
            node.references.erase(found);
        }
    }

    void findParents() {
        for (auto& node : all_.nodes) {
            if (const auto wanted =
                    ids_.nodeId(node.element.attribute("ParentNodeId").as_string("i=0"));
                !wanted) {
                problems_.add(node.element, "ParentNodeId: " + wanted.error().message);
                continue;
            }
            findOwnParent(node);
        }
        // Others may hold the reference to a node instead.
        for (const auto& node : all_.nodes) {
            for (const auto& reference : node.references) {
                const auto target = all_.index.find(reference.target);
                if (reference.forward && target != all_.index.end() &&
                    isHierarchical(reference.type)) {
                    adopt(all_.nodes[target->second], node, reference);
                }
            }
        }
        for (auto& node : all_.nodes) {
            check(node);
            node.is_instance = !isBelowAType(node);
        }
    }

    bool isBelowAType(const NodeElement& node) const {
        const auto* each = &node;
        for (std::size_t depth = 0; depth <= all_.nodes.size(); ++depth) {
            if (each->node_class == UA_NODECLASS_OBJECTTYPE ||
                each->node_class == UA_NODECLASS_VARIABLETYPE) {
                return true;
            }
            const auto parent = all_.index.find(each->parent);
            if (parent == all_.index.end()) {
                return false;
            }
            each = &all_.nodes[parent->second];
        }
        return false;  // above itself
    }

    static void adopt(NodeElement& child, const NodeElement& parent,
                      const ReferenceElement& reference) {
        if (child.parent.isNull()) {
            child.parent = parent.id;
            child.parent_reference = reference.type;
        }
    }

    void check(const NodeElement& node) {
        if (isInstance(node.node_class) && node.type_definition.isNull()) {
            problems_.add(node.element, "no HasTypeDefinition");
        } else if (!isInstance(node.node_class) && node.parent.isNull()) {
            problems_.add(node.element, "no reference from a parent");
        }
    }

    const NodesetFile& file_;
    const NodesetIds& ids_;
    TypeTree& tree_;
    NodesetProblems& problems_;
    NodeElements all_;
    std::unordered_map<NodeId, bool> hierarchical_;
};

}  // namespace

void NodesetProblems::add(const pugi::xml_node& element, std::string_view why) {
    if (++count_ <= kMostProblems) {
        lines_ += (lines_.empty() ? "" : "\n") + file_.problem(element, why);
    }
}

Error NodesetProblems::error() const {
    const auto more = count_ > kMostProblems
                          ? fmt::format("\n{}: {} more", file_.name(), count_ - kMostProblems)
                          : std::string();
    return {Errc::invalid_argument, lines_ + more};
}

NodeElements readNodes(const NodesetFile& file, const NodesetIds& ids, TypeTree& tree,
                       NodesetProblems& problems) {
    return NodeReading(file, ids, tree, problems).read();
}

}  // namespace metier::opcua
