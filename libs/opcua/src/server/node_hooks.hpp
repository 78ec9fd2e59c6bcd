#pragma once

#include <open62541/server.h>

#include <functional>
#include <memory>
#include <unordered_map>
#include <variant>

#include "metier/opcua/address_space.hpp"
#include "server/kept_values.hpp"

namespace metier::opcua {

class ServerCore;

struct MethodHooks {
    MethodHandler handler;
    std::function<bool(const Session&)> executable;
    MethodEffect effect = MethodEffect::commands;
};

/// Functions of a node; the stack keeps a pointer to them as the node's context.
struct NodeHooks {
    ServerCore* core = nullptr;
    std::variant<std::monostate, MethodHooks, DataSource, KeptValue> work;

    MethodHooks& methodHooks() {
        return std::holds_alternative<MethodHooks>(work) ? std::get<MethodHooks>(work)
                                                         : work.emplace<MethodHooks>();
    }
};

/// Owns the hooks of all nodes.
///
/// Threading: the server's thread.
class HookRegistry {
public:
    explicit HookRegistry(ServerCore& core) : core_(core) {}

    /// The hooks of a node, new ones if it has none. Errors: not_found (the node).
    Result<NodeHooks*> of(UA_Server* server, const NodeId& id);
    /// The hooks at a node's context, or null if the context is none of ours.
    NodeHooks* at(const void* context) noexcept;
    void erase(const void* context) { hooks_.erase(context); }

private:
    ServerCore& core_;
    std::unordered_map<const void*, std::unique_ptr<NodeHooks>> hooks_;
};

UA_StatusCode callMethod(UA_Server* server, const UA_NodeId* session_id, void* session_context,
                         const UA_NodeId* method_id, void* method_context,
                         const UA_NodeId* object_id, void* object_context, std::size_t input_size,
                         const UA_Variant* input, std::size_t output_size,
                         UA_Variant* output) noexcept;
/// The callbacks of a Variable whose hooks hold a DataSource.
UA_DataSource dataSourceCallbacks() noexcept;
/// The callbacks of a Variable whose context is a VariableSlot.
UA_DataSource slotCallbacks() noexcept;
/// The context of a Variable that only those read who may audit.
void* auditorsOnly() noexcept;
/// Whether the role of a session allows a Method.
bool mayCall(UA_Server* server, const void* session_context, const UA_NodeId& method_id,
             const void* method_context) noexcept;
/// Value of UserExecutable for a client.
UA_Boolean userExecutable(UA_Server* server, UA_AccessControl* control, const UA_NodeId* session_id,
                          void* session_context, const UA_NodeId* method_id,
                          void* method_context) noexcept;

}  // namespace metier::opcua
