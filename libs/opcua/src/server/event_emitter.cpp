#include "metier/opcua/event_emitter.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "common/convert.hpp"
#include "metier/opcua/server.hpp"
#include "server/event_types.hpp"
#include "server/server_core.hpp"

namespace metier::opcua {

namespace {

/// The fields of BaseEventType that we set; the stack sets the others.
enum BaseField { kTime, kSourceName, kSeverity, kMessage, kBaseFields };
constexpr std::array<const char*, kBaseFields> kBaseFieldNames{"Time", "SourceName", "Severity",
                                                               "Message"};

}  // namespace

struct EventEmitter::State {
    explicit State(ServerCore& owner) : core(owner) {}
    ~State() {
        if (!node.isNull()) {
            UA_Server_deleteNode(core.native(), viewOf(node), true);
        }
    }
    State(const State&) = delete;
    State& operator=(const State&) = delete;

    Result<> addField(const BrowsePath& path) {
        METIER_ASSIGN(auto id, core.nodes().find(node, path));
        fields.push_back(std::move(id));
        return {};
    }

    /// All fields, those that the stack sets too.
    Result<> hideFromOthers() {
        METIER_ASSIGN(const auto children, core.nodes().browse(node));
        for (const auto& child : children) {
            UA_Server_setNodeContext(core.native(), viewOf(child.target), auditorsOnly());
        }
        return {};
    }

    Result<> write(std::size_t field, const Value& value) {
        const auto code =
            UA_Server_writeValue(core.native(), viewOf(fields[field]), ValueAccess::native(value));
        if (code == UA_STATUSCODE_GOOD) {
            return {};
        }
        return fail(errorFrom(StatusCode(code),
                              fmt::format("{} in event field {}", value.typeName(), names[field])));
    }

    ServerCore& core;
    NodeId node;  ///< the event, reused
    std::vector<NodeId> fields;
    std::vector<std::string> names;
};

Result<EventEmitter> EventEmitter::create(Server& server, const NodeId& type,
                                          const std::vector<BrowsePath>& fields) {
    return create(*server.core_, type, fields);
}

Result<EventEmitter> EventEmitter::create(ServerCore& core, const NodeId& type,
                                          const std::vector<BrowsePath>& fields,
                                          EventAudience audience) {
    auto state = std::make_unique<State>(core);
    Owned<UA_NodeId> node(UA_TYPES[UA_TYPES_NODEID]);
    const auto code = UA_Server_createEvent(state->core.native(), viewOf(type), node.get());
    if (code != UA_STATUSCODE_GOOD) {
        return fail(errorFrom(StatusCode(code), "make an event of type " + type.toString()));
    }
    state->node = fromNative(*node);
    std::vector<BrowsePath> paths;
    for (const auto* name : kBaseFieldNames) {
        paths.push_back({QualifiedName{0, name}});
    }
    paths.insert(paths.end(), fields.begin(), fields.end());
    for (const auto& path : paths) {
        METIER_TRY(state->addField(path));
        state->names.push_back(path.back().name);
    }
    if (audience == EventAudience::auditors) {
        METIER_TRY(state->hideFromOthers());
    }
    METIER_TRY(completeFields(core.nodes(), state->node));
    return EventEmitter(std::move(state));
}

EventEmitter::EventEmitter(std::unique_ptr<State> state) : state_(std::move(state)) {}
EventEmitter::EventEmitter(EventEmitter&&) noexcept = default;
EventEmitter& EventEmitter::operator=(EventEmitter&&) noexcept = default;
EventEmitter::~EventEmitter() = default;

Result<ByteString> EventEmitter::emit(const Event& event) {
    if (event.fields.size() + kBaseFields != state_->fields.size()) {
        return fail(Errc::invalid_argument,
                    fmt::format("{} event fields where {} are expected", event.fields.size(),
                                state_->fields.size() - kBaseFields));
    }
    if (state_->core.nobodyHears(event.source)) {
        return ByteString{};
    }
    const std::array<Value, kBaseFields> base{Value::of(event.time), Value::of(event.source_name),
                                              Value::of(event.severity), Value::of(event.message)};
    for (std::size_t i = 0; i < state_->fields.size(); ++i) {
        const auto& value = i < kBaseFields ? base[i] : event.fields[i - kBaseFields];
        METIER_TRY(state_->write(i, value));
    }
    Owned<UA_ByteString> id(UA_TYPES[UA_TYPES_BYTESTRING]);
    const auto code = state_->core.raise(state_->node, event.source, id.get());
    if (code != UA_STATUSCODE_GOOD) {
        return fail(errorFrom(StatusCode(code), "raise an event of " + event.source.toString()));
    }
    state_->core.publishEventsOf(event.source);
    return bytesFrom(*id);
}

}  // namespace metier::opcua
