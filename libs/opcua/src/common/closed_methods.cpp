#include "common/closed_methods.hpp"

#include <open62541/plugin/nodestore.h>

#include <vector>

#include "common/convert.hpp"
#include "common/guard.hpp"

namespace metier::opcua {

namespace {

UA_StatusCode withoutWork(UA_Server* /*server*/, const UA_NodeId* /*session_id*/,
                          void* /*session_context*/, const UA_NodeId* /*method*/,
                          void* /*method_context*/, const UA_NodeId* /*object*/,
                          void* /*object_context*/, std::size_t /*inputs_size*/,
                          const UA_Variant* /*inputs*/, std::size_t /*outputs_size*/,
                          UA_Variant* /*outputs*/) noexcept {
    return UA_STATUSCODE_BADNOTIMPLEMENTED;
}

UA_StatusCode give(UA_Server* server, const UA_NodeId& method, UA_MethodCallback work,
                   UA_Boolean executable) {
    return inOrder([&] { return UA_Server_setMethodNodeCallback(server, method, work); },
                   [&] { return UA_Server_writeExecutable(server, method, executable); });
}

struct Idle {
    std::vector<NodeId> methods;
    UA_StatusCode code = UA_STATUSCODE_GOOD;

    static void visit(void* context, const UA_Node* node) noexcept {
        if (node->head.nodeClass != UA_NODECLASS_METHOD || node->methodNode.method != nullptr) {
            return;
        }
        auto& found = *static_cast<Idle*>(context);
        const auto code = guarded([&] { found.methods.push_back(fromNative(node->head.nodeId)); });
        found.code = code == UA_STATUSCODE_GOOD ? found.code : code;
    }
};

}  // namespace

UA_StatusCode closeMethod(UA_Server* server, const UA_NodeId& method) {
    return give(server, method, withoutWork, false);
}

UA_StatusCode openMethod(UA_Server* server, const UA_NodeId& method, UA_MethodCallback work) {
    return give(server, method, work, true);
}

UA_StatusCode closeIdleMethods(UA_Server* server) {
    const auto& store = UA_Server_getConfig(server)->nodestore;
    Idle idle;
    store.iterate(store.context, Idle::visit, &idle);
    auto code = idle.code;
    for (const auto& method : idle.methods) {
        code = code == UA_STATUSCODE_GOOD ? closeMethod(server, viewOf(method)) : code;
    }
    return code;
}

}  // namespace metier::opcua
