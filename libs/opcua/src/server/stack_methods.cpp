#include "server/stack_methods.hpp"

#include <open62541/plugin/nodestore.h>

#include <algorithm>

#include "server/server_core.hpp"

namespace metier::opcua {

struct StackMethods::Callbacks {
    static UA_StatusCode call(UA_Server* server, const UA_NodeId* session_id, void* session_context,
                              const UA_NodeId* method_id, void* method_context,
                              const UA_NodeId* object_id, void* object_context,
                              std::size_t input_size, const UA_Variant* input,
                              std::size_t output_size, UA_Variant* output) noexcept {
        const bool all_scalars = std::all_of(input, input + input_size, [](const UA_Variant& each) {
            return UA_Variant_isScalar(&each);
        });
        const auto number = static_cast<int>(method_id->identifier.numeric);
        const auto at = std::find(kIds.begin(), kIds.end(), number) - kIds.begin();
        const auto behind =
            ServerCore::of(server).stackMethods().behind_[static_cast<std::size_t>(at)];
        return all_scalars
                   ? behind(server, session_id, session_context, method_id, method_context,
                            object_id, object_context, input_size, input, output_size, output)
                   : UA_STATUSCODE_BADINVALIDARGUMENT;
    }
};

bool StackMethods::isOfOwnSession(const UA_NodeId& method) noexcept {
    return method.namespaceIndex == 0 && method.identifierType == UA_NODEIDTYPE_NUMERIC &&
           std::find(kIds.begin(), kIds.end(), static_cast<int>(method.identifier.numeric)) !=
               kIds.end();
}

Result<> StackMethods::guard(UA_Server* server) {
    auto& store = UA_Server_getConfig(server)->nodestore;
    for (std::size_t i = 0; i < kIds.size(); ++i) {
        const UA_NodeId id = UA_NODEID_NUMERIC(0, static_cast<UA_UInt32>(kIds.at(i)));
        const UA_Node* node = store.getNode(store.context, &id, UA_NODEATTRIBUTESMASK_ALL,
                                            UA_REFERENCETYPESET_NONE, UA_BROWSEDIRECTION_FORWARD);
        if (node == nullptr) {
            return fail(Errc::internal, "the stack lacks a Method of the Server object");
        }
        behind_.at(i) = node->methodNode.method;
        store.releaseNode(store.context, node);
        if (UA_Server_setMethodNodeCallback(server, id, Callbacks::call) != UA_STATUSCODE_GOOD) {
            return fail(Errc::internal, "a Method of the stack cannot be guarded");
        }
    }
    return {};
}

}  // namespace metier::opcua
