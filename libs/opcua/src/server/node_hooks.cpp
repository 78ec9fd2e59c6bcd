#include "server/node_hooks.hpp"

#include <algorithm>
#include <array>

#include "common/convert.hpp"
#include "common/guard.hpp"
#include "metier/opcua/text.hpp"
#include "server/server_core.hpp"
#include "server/stack_methods.hpp"

namespace metier::opcua {

namespace {

/// A Value that only lends the variant's content: for handlers, which get it as const.
Value lend(const UA_Variant& variant) noexcept {
    UA_Variant view = variant;
    view.storageType = UA_VARIANT_DATA_NODELETE;
    return ValueAccess::take(view);
}

std::vector<Value> lendAll(const UA_Variant* variants, std::size_t size) {
    std::vector<Value> values;
    values.reserve(size);
    for (std::size_t i = 0; i < size; ++i) {
        values.push_back(lend(variants[i]));
    }
    return values;
}

UA_StatusCode handOver(std::vector<Value>& results, UA_Variant* output, std::size_t size) {
    if (results.size() != size) {
        return UA_STATUSCODE_BADINTERNALERROR;
    }
    for (std::size_t i = 0; i < size; ++i) {
        output[i] = std::exchange(ValueAccess::native(results[i]), UA_Variant{});
    }
    return UA_STATUSCODE_GOOD;
}

/// Hands a value to the stack as the client asked for it.
UA_StatusCode handOver(DataValue value, UA_Boolean source_time, const UA_NumericRange* range,
                       UA_DataValue& result) {
    if (!source_time) {
        value.source_time = UtcTime{};
    } else if (value.source_time == UtcTime{}) {
        value.source_time = std::chrono::system_clock::now();
    }
    if (range == nullptr) {
        toNative(value, result);
        return UA_STATUSCODE_GOOD;
    }
    Owned<UA_DataValue> whole(UA_TYPES[UA_TYPES_DATAVALUE]);
    toNative(value, *whole);
    return UA_DataValue_copyVariantRange(whole.get(), &result, *range);
}

/// Lets `write` take what a client wrote, if the client itself says that it is good: no Variable
/// has the access bit StatusWrite, and a set-point of bad quality must not move an arm.
template <typename Write>
UA_StatusCode handIn(ServerCore& core, void* session_context, const UA_NodeId& id,
                     const UA_DataValue& value, const Write& write) {
    if (value.hasStatus && value.status != UA_STATUSCODE_GOOD) {
        core.log().info("write of {} refused: it has the StatusCode {}", fromNative(id).toString(),
                        StatusCode(value.status).name());
        return UA_STATUSCODE_BADWRITENOTSUPPORTED;
    }
    const Value lent = lend(value.value);
    const WriteContext writer{
        core.sessions().of(session_context),
        value.hasSourceTimestamp ? std::optional(timeFrom(value.sourceTimestamp)) : std::nullopt};
    const Result<> taken = write(writer, lent);
    if (taken) {
        return UA_STATUSCODE_GOOD;
    }
    core.log().info("write of {} refused: {}", fromNative(id).toString(),
                    sanitise(taken.error().message));
    return statusFrom(taken.error().code).value();
}

UA_StatusCode readSlot(UA_Server* server, const UA_NodeId* /*session_id*/, void* session_context,
                       const UA_NodeId* /*id*/, void* context, UA_Boolean source_time,
                       const UA_NumericRange* range, UA_DataValue* result) noexcept {
    return guarded([&]() -> UA_StatusCode {
        const auto& slot = *static_cast<const VariableSlot*>(context);
        const auto& session = ServerCore::of(server).sessions().of(session_context);
        return handOver(slot.handler->read(session, slot.tag), source_time, range, *result);
    });
}

UA_StatusCode writeSlot(UA_Server* server, const UA_NodeId* /*session_id*/, void* session_context,
                        const UA_NodeId* id, void* context, const UA_NumericRange* range,
                        const UA_DataValue* value) noexcept {
    return guarded([&]() -> UA_StatusCode {
        if (range != nullptr) {
            return status::kBadWriteNotSupported.value();
        }
        const auto& slot = *static_cast<const VariableSlot*>(context);
        return handIn(ServerCore::of(server), session_context, *id, *value,
                      [&](const WriteContext& writer, const Value& lent) {
                          return slot.handler->write(writer, slot.tag, lent);
                      });
    });
}

UA_StatusCode readSource(UA_Server* /*server*/, const UA_NodeId* /*session_id*/,
                         void* session_context, const UA_NodeId* /*id*/, void* context,
                         UA_Boolean source_time, const UA_NumericRange* range,
                         UA_DataValue* result) noexcept {
    return guarded([&]() -> UA_StatusCode {
        const auto& hooks = *static_cast<NodeHooks*>(context);
        const auto& session = hooks.core->sessions().of(session_context);
        return handOver(std::get<DataSource>(hooks.work).read(session), source_time, range,
                        *result);
    });
}

UA_StatusCode writeSource(UA_Server* /*server*/, const UA_NodeId* /*session_id*/,
                          void* session_context, const UA_NodeId* id, void* context,
                          const UA_NumericRange* range, const UA_DataValue* value) noexcept {
    return guarded([&]() -> UA_StatusCode {
        const auto& hooks = *static_cast<NodeHooks*>(context);
        const auto& source = std::get<DataSource>(hooks.work);
        if (range != nullptr || !source.write) {
            return status::kBadWriteNotSupported.value();
        }
        return handIn(*hooks.core, session_context, *id, *value, source.write);
    });
}

}  // namespace

UA_StatusCode callMethod(UA_Server* server, const UA_NodeId* /*session_id*/, void* session_context,
                         const UA_NodeId* method_id, void* method_context,
                         const UA_NodeId* object_id, void* /*object_context*/,
                         std::size_t input_size, const UA_Variant* input, std::size_t output_size,
                         UA_Variant* output) noexcept {
    return guarded([&]() -> UA_StatusCode {
        const auto& hooks = *static_cast<NodeHooks*>(method_context);
        const auto& method = std::get<MethodHooks>(hooks.work);
        const auto arguments = lendAll(input, input_size);
        const CallContext context{hooks.core->sessions().of(session_context),
                                  fromNative(*object_id), fromNative(*method_id)};
        if (!mayCall(server, session_context, *method_id, method_context)) {
            hooks.core->tellDenial(context);
            return UA_STATUSCODE_BADUSERACCESSDENIED;
        }
        std::string why;
        const auto code = guarded([&]() -> UA_StatusCode {
            auto results = method.handler(context, arguments);
            if (results) {
                return handOver(*results, output, output_size);
            }
            why = std::move(results.error().message);
            hooks.core->log().info("call of {} on {} refused: {}", context.method.toString(),
                                   context.object.toString(), sanitise(why));
            return statusFrom(results.error().code).value();
        });
        if (method.effect == MethodEffect::commands) {
            hooks.core->audit().called(context, arguments, StatusCode(code), why);
        }
        return code;
    });
}

UA_DataSource dataSourceCallbacks() noexcept {
    return {readSource, writeSource};
}

UA_DataSource slotCallbacks() noexcept {
    return {readSlot, writeSlot};
}

void* auditorsOnly() noexcept {
    static char mark = 0;
    return &mark;
}

bool mayCall(UA_Server* server, const void* session_context, const UA_NodeId& method_id,
             const void* method_context) noexcept {
    auto& core = ServerCore::of(server);
    if (session_context == nullptr || StackMethods::isOfOwnSession(method_id)) {
        return true;
    }
    const auto* hooks = core.hooks().at(method_context);
    if (hooks != nullptr && mayCommand(core.sessions().of(session_context).role)) {
        return true;
    }
    const auto* method = hooks == nullptr ? nullptr : std::get_if<MethodHooks>(&hooks->work);
    return method != nullptr && method->effect == MethodEffect::tells;
}

UA_Boolean userExecutable(UA_Server* server, UA_AccessControl* /*control*/,
                          const UA_NodeId* /*session_id*/, void* session_context,
                          const UA_NodeId* method_id, void* method_context) noexcept {
    bool executable = mayCall(server, session_context, *method_id, method_context);
    if (!executable) {
        return false;
    }
    guarded([&] {
        auto& core = ServerCore::of(server);
        const auto* hooks = core.hooks().at(method_context);
        const auto* method = hooks == nullptr ? nullptr : std::get_if<MethodHooks>(&hooks->work);
        if (method != nullptr && method->executable) {
            executable = method->executable(core.sessions().of(session_context));
        }
    });
    return executable;
}

Result<NodeHooks*> HookRegistry::of(UA_Server* server, const NodeId& id) {
    void* context = nullptr;
    const auto got = UA_Server_getNodeContext(server, viewOf(id), &context);
    if (got != UA_STATUSCODE_GOOD) {
        return fail(errorFrom(StatusCode(got), id.toString()));
    }
    if (NodeHooks* known = at(context)) {
        return known;
    }
    auto hooks = std::make_unique<NodeHooks>();
    hooks->core = &core_;
    NodeHooks* added = hooks.get();
    hooks_.emplace(added, std::move(hooks));
    UA_Server_setNodeContext(server, viewOf(id), added);
    return added;
}

NodeHooks* HookRegistry::at(const void* context) noexcept {
    const auto found = hooks_.find(context);
    return found == hooks_.end() ? nullptr : found->second.get();
}

}  // namespace metier::opcua
