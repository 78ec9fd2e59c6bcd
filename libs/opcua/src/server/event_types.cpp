#include "server/event_types.hpp"

#include <fmt/format.h>
#include <open62541/plugin/nodestore.h>

#include <algorithm>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "common/convert.hpp"

namespace metier::opcua {

namespace {

/// An event type and all types above it.
struct Lineage {
    NodeId type;
    std::vector<NodeId> above;
};

UA_StatusCode refer(UA_Node& node, const std::vector<NodeId>& above) {
    constexpr UA_UInt32 kAnotherServer = 1;
    constexpr UA_UInt32 kFoundByNoName = 0;
    for (const auto& type : above) {
        const UA_ExpandedNodeId target{viewOf(type), UA_STRING_NULL, kAnotherServer};
        const auto code = UA_Node_addReference(&node, UA_REFERENCETYPEINDEX_HASSUBTYPE, true,
                                               &target, kFoundByNoName);
        if (code != UA_STATUSCODE_GOOD) {
            return code;
        }
    }
    return UA_STATUSCODE_GOOD;
}

UA_StatusCode refer(UA_Nodestore& store, const Lineage& lineage) {
    const UA_NodeId id = viewOf(lineage.type);
    UA_Node* node = nullptr;
    auto code = store.getNodeCopy(store.context, &id, &node);
    if (code != UA_STATUSCODE_GOOD) {
        return code;
    }
    code = refer(*node, lineage.above);
    if (code != UA_STATUSCODE_GOOD) {
        store.deleteNode(store.context, node);
        return code;
    }
    return store.replaceNode(store.context, node);
}

/// A node that declares or has fields, and the Variable that stands for it where it is absent.
struct FieldPair {
    NodeId node;
    NodeId absent;
};

const NodeId& absentRoot() {
    static const NodeId root(1, "AbsentEventFields");
    return root;
}

/// Fields of one name in two namespaces have two ids, unlike childId().
NodeId absentId(const NodeId& parent, const QualifiedName& name) {
    return {1, fmt::format("{}.{}:{}", std::get<std::string>(parent.identifier()),
                           name.namespace_index, name.name)};
}

Value noValue() {
    Value value;
    ValueAccess::native(value).type = &UA_TYPES[UA_TYPES_EXTENSIONOBJECT];
    return value;
}

bool isField(const Reference& child) {
    return child.node_class == NodeClass::variable || child.node_class == NodeClass::object;
}

Result<> addAbsent(AddressSpace& nodes, const FieldPair& parent, const Reference& declared) {
    const VariableSpec spec{.node = {.id = absentId(parent.absent, declared.browse_name),
                                     .parent = parent.absent,
                                     .browse_name = declared.browse_name},
                            .value_rank = UA_VALUERANK_ANY,
                            .value = noValue(),
                            .children = Children::none};
    METIER_TRY(nodes.exists(spec.node.id) ? Result<NodeId>(spec.node.id) : nodes.addVariable(spec));
    return {};
}

/// Adds what is directly below a node, and appends it to `open`.
Result<> addAbsentBelow(AddressSpace& nodes, const FieldPair& parent,
                        std::vector<FieldPair>& open) {
    METIER_ASSIGN(const auto children, nodes.browse(parent.node));
    for (const auto& child : children) {
        if (isField(child)) {
            METIER_TRY(addAbsent(nodes, parent, child));
            open.push_back({child.target, absentId(parent.absent, child.browse_name)});
        }
    }
    return {};
}

/// Adds what is below a type, to all depths.
Result<> addAbsentOf(AddressSpace& nodes, const NodeId& type) {
    std::vector<FieldPair> open{{type, absentRoot()}};
    while (!open.empty()) {
        const auto next = std::move(open.back());
        open.pop_back();
        METIER_TRY(addAbsentBelow(nodes, next, open));
    }
    return {};
}

/// BaseEventType and all types below it.
Result<std::vector<Lineage>> eventTypes(const AddressSpace& nodes) {
    std::vector<Lineage> types{{ids::kBaseEventType, {}}};
    for (std::size_t next = 0; next < types.size(); ++next) {
        METIER_ASSIGN(const auto below, nodes.browse(types[next].type, {ids::kHasSubtype}));
        auto above = types[next].above;
        above.push_back(types[next].type);
        for (const auto& subtype : below) {
            types.push_back({subtype.target, above});
        }
    }
    return types;
}

/// Adds to a node the fields that it lacks; appends those that it has to `open`.
Result<> completeBelow(AddressSpace& nodes, const FieldPair& parent, std::vector<FieldPair>& open) {
    METIER_ASSIGN(const auto there, nodes.browse(parent.node));
    METIER_ASSIGN(const auto all, nodes.browse(parent.absent));
    for (const auto& field : all) {
        const auto same = std::find_if(there.begin(), there.end(), [&](const Reference& child) {
            return child.browse_name == field.browse_name;
        });
        if (same != there.end()) {
            open.push_back({same->target, field.target});
        } else {
            METIER_TRY(nodes.addReference(parent.node, ids::kHasComponent, field.target));
        }
    }
    return {};
}

}  // namespace

Result<> inheritEventFields(UA_Server* server, const AddressSpace& nodes) {
    auto& store = UA_Server_getConfig(server)->nodestore;
    METIER_ASSIGN(const auto types, eventTypes(nodes));
    for (const auto& each : types) {
        if (refer(store, each) != UA_STATUSCODE_GOOD) {
            return fail(Errc::internal, "an event type cannot refer to the types above it");
        }
    }
    return {};
}

Result<> addAbsentFields(AddressSpace& nodes) {
    METIER_ASSIGN(const auto types, eventTypes(nodes));
    METIER_TRY(
        nodes.addObject({.node = {.id = absentRoot(), .browse_name = {1, "AbsentEventFields"}}}));
    for (const auto& each : types) {
        METIER_TRY(addAbsentOf(nodes, each.type));
    }
    return {};
}

Result<> completeFields(AddressSpace& nodes, const NodeId& event) {
    std::vector<FieldPair> open{{event, absentRoot()}};
    while (!open.empty()) {
        const auto next = std::move(open.back());
        open.pop_back();
        METIER_TRY(completeBelow(nodes, next, open));
    }
    return {};
}

}  // namespace metier::opcua
