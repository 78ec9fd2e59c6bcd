#include "server/event_types.hpp"

#include <open62541/plugin/nodestore.h>

#include <utility>
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
    auto code = UA_STATUSCODE_GOOD;
    for (const auto& type : above) {
        const UA_ExpandedNodeId target{viewOf(type), UA_STRING_NULL, kAnotherServer};
        code = code != UA_STATUSCODE_GOOD
                   ? code
                   : UA_Node_addReference(&node, UA_REFERENCETYPEINDEX_HASSUBTYPE, true, &target,
                                          kFoundByNoName);
    }
    return code;
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

}  // namespace

Result<> inheritEventFields(UA_Server* server, const AddressSpace& nodes) {
    auto& store = UA_Server_getConfig(server)->nodestore;
    std::vector<Lineage> open{{ids::kBaseEventType, {}}};
    while (!open.empty()) {
        auto next = std::move(open.back());
        open.pop_back();
        if (refer(store, next) != UA_STATUSCODE_GOOD) {
            return fail(Errc::internal, "an event type cannot refer to the types above it");
        }
        METIER_ASSIGN(const auto below, nodes.browse(next.type, {ids::kHasSubtype}));
        next.above.push_back(next.type);
        for (const auto& subtype : below) {
            open.push_back({subtype.target, next.above});
        }
    }
    return {};
}

}  // namespace metier::opcua
