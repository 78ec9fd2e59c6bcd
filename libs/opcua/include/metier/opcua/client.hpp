#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "metier/base/clock.hpp"
#include "metier/opcua/answer.hpp"
#include "metier/opcua/connection.hpp"
#include "metier/opcua/node_id.hpp"
#include "metier/opcua/security.hpp"
#include "metier/opcua/standard_ids.hpp"
#include "metier/opcua/types.hpp"
#include "metier/opcua/value.hpp"

namespace metier::opcua {

class ClientCore;

/// A person or program that the server knows by name. Over a connection without security the
/// password travels as clear text, unless the server's policy for tokens asks for more.
struct UserName {
    std::string name;
    std::string password;
};

struct ClientOptions {
    std::string application_name = "metier client";
    std::string application_uri = "urn:metier:client";
    std::optional<UserName> user{};  ///< none: anonymous
    /// None: without security. Else everything is signed and encrypted, the server's certificate
    /// must be trusted, and application_uri is that of the own certificate. A server's certificate
    /// that is not trusted is kept among those to decide on.
    std::optional<Credentials> security{};
    std::chrono::milliseconds connect_timeout{5'000};
    /// Silence after which the server may forget this client; it is asked for something, and
    /// given up if it does not answer, well before that. At least 2 s.
    std::chrono::milliseconds session_timeout{30'000};
    std::chrono::milliseconds call_timeout{5'000};  ///< of every call that names none of its own
    std::chrono::milliseconds publishing_interval{100};
    /// What to do when the connection breaks; none: it is lost for good, make a new Client.
    std::optional<ReconnectOptions> reconnect{};
};

/// How long one call may take; none: ClientOptions::call_timeout.
using Timeout = std::optional<std::chrono::milliseconds>;

/// The attributes of nodes (OPC 10000-3, 5; numbers of OPC 10000-6, A.1).
enum class AttributeId : std::uint32_t {
    node_id = 1,
    node_class = 2,
    browse_name = 3,
    display_name = 4,
    description = 5,
    is_abstract = 8,
    event_notifier = 12,
    value = 13,
    data_type = 14,
    value_rank = 15,
    array_dimensions = 16,
    access_level = 17,
    user_access_level = 18,
    executable = 21,
    user_executable = 22,
};

struct ReadItem {
    NodeId node;
    AttributeId attribute = AttributeId::value;
};

struct WriteItem {
    NodeId node;
    Value value;
    std::optional<UtcTime> source_time{};  ///< none: not sent, the server takes its own
    std::uint64_t boot = 0;                ///< as MethodCall::boot
};

struct MethodCall {
    NodeId object;
    NodeId method;
    std::vector<Value> inputs{};
    /// Client::boot() when the NodeIds were looked up: refused if the server was started again
    /// since, as they may name something else now. 0: sent in any case.
    std::uint64_t boot = 0;
};

/// What a Method answered that was not refused.
struct CallResult {
    StatusCode status;  ///< Good or Uncertain
    std::vector<StatusCode> input_results;
    std::vector<Value> outputs;
};

/// Which references of a node are asked for.
struct BrowseQuery {
    enum class Direction { forward, inverse, both };

    NodeId node;
    NodeId reference_type = ids::kHierarchicalReferences;  ///< with its subtypes; null: all
    Direction direction = Direction::forward;
    std::vector<NodeClass> node_classes{};  ///< of the targets; empty: all
    std::uint32_t references_at_once = 0;   ///< per message, 0: as many as the server sends
};

/// One reference of a node, and what it leads to.
struct ReferenceDescription {
    NodeId reference_type;
    bool is_forward = true;
    NodeId target;
    QualifiedName browse_name;
    LocalizedText display_name;
    NodeClass node_class = NodeClass::unspecified;
    NodeId type_definition;
};

/// A way along hierarchical references.
struct RelativePath {
    NodeId start;
    std::vector<QualifiedName> names;
};

/// What a subscriber of events asks for.
struct EventFilter {
    /// Fields of BaseEventType and its subtypes by BrowsePath, such as {{0, "Message"}} or
    /// {{0, "Transition"}, {0, "Number"}}; at least one. A server refuses, by name, a field that
    /// none of its event types has.
    std::vector<std::vector<QualifiedName>> fields;
    std::optional<NodeId> of_type{};    ///< only events of this type and its subtypes
    std::uint32_t queue_size = 10'000;  ///< [events] the server may keep for us; it may keep less
};

/// What a subscriber of events is told.
struct EventNotice {
    enum class Kind {
        event,     ///< `fields` holds a value per field asked for, Null where the event has none
        overflow,  ///< events were lost: the server's queue, or a message, went missing
        ended,     ///< nothing will come any more: `status` says why
        /// The connection is lost, `status` says why; `resumed` or `ended` follows.
        interrupted,
        /// Events come again. Those meanwhile come now if the server kept them for this session;
        /// if not, `overflow` comes before.
        resumed,
    };

    Kind kind = Kind::event;
    std::vector<Value> fields;
    StatusCode status;
};

/// What a subscriber of a Variable asks for.
struct DataFilter {
    std::chrono::milliseconds sampling_interval{100};  ///< 0: as fast as the server can
    std::uint32_t queue_size = 1;                      ///< [values] kept between publications
};

/// Notifications of one node, for as long as it lives.
///
/// Once the destructor has returned its callback does not run any more; it waits at most 5 s for
/// a callback that runs at that moment. The server is told later, nobody waits for it.
///
/// Threading: one owner; may be destroyed on any thread, in a callback too, and after its Client.
class Subscription {
public:
    Subscription() = default;
    ~Subscription();
    Subscription(Subscription&& other) noexcept;
    Subscription& operator=(Subscription&& other) noexcept;

private:
    friend class Client;
    Subscription(std::shared_ptr<ClientCore> core, std::uint32_t handle);
    void end() noexcept;

    std::shared_ptr<ClientCore> core_;  // with the Client, whichever ends last
    std::uint32_t handle_ = 0;
};

/// One session with one OPC UA server, over a connection without security (SecurityPolicy None).
///
/// Every call has a deadline, and a broken connection ends all calls at once. Nothing is ever sent
/// twice, nor after its deadline, nor kept for later: without a connection a call fails at once.
///
/// With ClientOptions::reconnect it connects again by itself: to the same session where the server
/// still has it, else to a new one. Subscriptions are taken up again or made anew, with the
/// namespace indices that hold then; other NodeIds are the caller's to look up again when boot()
/// has changed. A connection is also given up when the server is silent: an idle one is asked
/// every 2 s, or every third of the session time-out if that is less.
///
/// Errors of every call, besides those of the server: timeout (BadTimeout), connection_lost (also
/// after close()), invalid_state (a waiting call from a callback of this client),
/// resource_unavailable (2000 requests are unanswered). Failure::delivery tells whether the request
/// left: after `unknown` a command may have been carried out, so ask before it is given again.
///
/// Threading: any thread may call anything but the destructor, and many may at once. Waiting calls
/// block theirs. One thread of its own serves the connection and runs all callbacks, which must
/// neither wait nor throw: of this client they may use what ends in Async, state() and the
/// destructor of a Subscription; waiting calls and close() are refused.
class Client {
public:
    /// Errors: invalid_argument (the URL, a time that is not positive), connection_lost (nobody
    /// there), access_denied (user or password), timeout.
    static Answer<std::unique_ptr<Client>> connect(const std::string& url,
                                                   ClientOptions options = {});
    /// Closes. No callback may run it.
    ~Client();
    Client(const Client&) = delete;
    Client& operator=(const Client&) = delete;

    /// Ends the session within about a second, whatever the server does; pending calls fail with
    /// connection_lost. May be called again.
    /// Errors: invalid_state (from a callback).
    Answer<> close();

    enum class State {
        connected,
        reconnecting,
        lost,  ///< for good: whyLost()
        closed,
    };
    State state() const noexcept;
    /// Why there is no connection, or was none the last time; none: there always was one.
    std::optional<Failure> whyLost() const;
    /// Which run of the server this client is connected to: 1 for the first, one more whenever the
    /// server was started again. NodeIds hold for one of them.
    std::uint64_t boot() const noexcept;
    /// Waits until it is connected.
    /// Errors: timeout at the deadline; connection_lost (given up, closed); invalid_state.
    Answer<> awaitConnected(SteadyTime deadline);

    /// What is to hear of each change of the connection, on the client's thread, which may not
    /// wait there. Not called after close(). A later callback replaces an earlier one.
    void onConnectionChange(std::function<void(const ConnectionChange&)> callback);

    /// What is to happen once when the connection is lost for good; at once if it was already. Not
    /// called after close(). A later callback replaces an earlier one.
    void onConnectionLost(std::function<void(const Failure&)> callback);

    /// Errors: the attribute's own StatusCode where Bad, such as not_found (BadNodeIdUnknown).
    Answer<Value> read(const NodeId& node, AttributeId attribute = AttributeId::value,
                       Timeout timeout = {});
    /// One DataValue per item, in order, with its own StatusCode.
    Answer<std::vector<DataValue>> readMany(std::vector<ReadItem> items, Timeout timeout = {});

    /// Errors: the node's own StatusCode where Bad, such as out_of_range or locked.
    Answer<> write(NodeId node, Value value, std::optional<UtcTime> source_time = {},
                   Timeout timeout = {});
    /// One StatusCode per item, in order.
    Answer<std::vector<StatusCode>> writeMany(std::vector<WriteItem> items, Timeout timeout = {});

    /// Calls a Method. Errors: the Method's own StatusCode where Bad, such as invalid_state; what
    /// it said to each argument is in Failure::input_results.
    Answer<CallResult> call(MethodCall method_call, Timeout timeout = {});
    Answer<CallResult> call(NodeId object, NodeId method, std::vector<Value> inputs = {});

    /// All references asked for, over as many messages as it takes. References to nodes of other
    /// servers are left out.
    Answer<std::vector<ReferenceDescription>> browse(BrowseQuery query, Timeout timeout = {});

    /// The node at the end of a path; the first one if there are several.
    /// Errors: not_found (BadNoMatch; BadNodeIdUnknown for the start).
    Answer<NodeId> translate(const NodeId& start, std::vector<QualifiedName> names,
                             Timeout timeout = {});
    /// An Answer per path, in order.
    Answer<std::vector<Answer<NodeId>>> translateMany(std::vector<RelativePath> paths,
                                                      Timeout timeout = {});

    /// The server's NamespaceArray, read anew.
    Answer<std::vector<std::string>> namespaceArray(Timeout timeout = {});
    /// Errors: not_found.
    Answer<std::uint16_t> namespaceIndex(std::string_view uri, Timeout timeout = {});

    /// Whether this user may call the Method now.
    Answer<bool> readUserExecutable(const NodeId& method, Timeout timeout = {});

    /// Writes without waiting; `done` hears the outcome exactly once, at the latest at the
    /// deadline, on the client's thread. Writes are sent in the order of these calls.
    /// Errors: connection_lost, here and at once: then `done` is not called.
    Answer<> writeAsync(WriteItem item, std::function<void(Answer<>)> done, Timeout timeout = {});
    /// As writeAsync(), for a Method.
    Answer<> callAsync(MethodCall method_call, std::function<void(Answer<CallResult>)> done,
                       Timeout timeout = {});

    /// Hears of the events of a notifier. The callback may run before this returns.
    /// Errors: the server's, and invalid_argument for a field or filter that it rejects.
    Answer<Subscription> subscribeEvents(NodeId notifier, EventFilter filter,
                                         std::function<void(const EventNotice&)> callback,
                                         Timeout timeout = {});
    /// Hears of a Variable's changes, its value now first. A lost value shows in the Overflow bit
    /// of a StatusCode. An empty Value with a Bad one comes when connection or Subscription end; it
    /// is the last notice unless the client reconnects. The callback may run before this returns.
    Answer<Subscription> subscribeData(NodeId variable, DataFilter filter,
                                       std::function<void(const DataValue&)> callback,
                                       Timeout timeout = {});

private:
    explicit Client(std::shared_ptr<ClientCore> core);
    template <typename Item>
    Answer<Subscription> subscribe(Item item, Timeout timeout);

    std::shared_ptr<ClientCore> core_;  // with its Subscriptions, which may end later
};

}  // namespace metier::opcua
