#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "metier/opcua/address_space.hpp"

namespace metier::opcua {

class Server;
class ServerCore;  // of src/

/// One occurrence of an event.
struct Event {
    /// Object on which it occurs, below Objects: SourceNode.
    NodeId source;
    /// Name of that Object: SourceName.
    std::string source_name;
    /// Time of the occurrence, by the server's wall clock.
    UtcTime time;
    /// Severity of OPC 10000-5, 1 (least) to 1000.
    std::uint16_t severity = 0;
    /// Text for people.
    LocalizedText message;
    /// Values of the type's own fields, in the order of the list given to create().
    std::vector<Value> fields;
};

/// Readers of the fields of events. The stack sends an event to every subscriber; a session that
/// may not read it gets Null in all fields, EventType included.
enum class EventAudience {
    /// Every subscriber.
    everybody,
    /// Only sessions for which mayAudit().
    auditors,
};

/// Raises events of one type:
///
///     auto emitter = EventEmitter::create(server, type, {{{0, "ToState"}, {0, "Number"}}});
///     emitter->emit({.source = object, .severity = 100, .fields = {Value::of(number)}});
///
/// The stack makes a node for an event and lets Subscriptions pick its fields; making it costs a
/// hundred times what raising does. So one node is made here and used for every event, which is
/// sound because Subscriptions copy the fields when the event is raised.
///
/// Threading: the server's thread; must not outlive the Server.
class EventEmitter {
public:
    /// \param type    a subtype of BaseEventType
    /// \param fields  paths of the type's own mandatory fields: {{0, "ToState"}, {0, "Number"}}
    /// Errors: not_found (type, or a field, named), invalid_argument (not an event type).
    static Result<EventEmitter> create(Server& server, const NodeId& type,
                                       const std::vector<BrowsePath>& fields);
    /// The same for this library.
    /// \param audience readers of the fields
    static Result<EventEmitter> create(ServerCore& core, const NodeId& type,
                                       const std::vector<BrowsePath>& fields,
                                       EventAudience audience = EventAudience::everybody);
    ~EventEmitter();
    EventEmitter(EventEmitter&&) noexcept;
    EventEmitter& operator=(EventEmitter&&) noexcept;

    /// Raises the event on its source, on every notifier above it and on the Server object. It is
    /// published at once if the server is so configured.
    /// \return its EventId; empty if no client has subscribed to one of these notifiers: then
    ///         nothing is raised
    /// Errors: invalid_argument (number of fields), type_mismatch (a field, named), not_found
    /// (source). Nothing is raised then.
    Result<ByteString> emit(const Event& event);

private:
    struct State;
    explicit EventEmitter(std::unique_ptr<State> state);
    std::unique_ptr<State> state_;
};

}  // namespace metier::opcua
