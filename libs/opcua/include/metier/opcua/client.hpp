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

/// User name and password of a session. Over a connection without security the password travels as
/// clear text, unless the server's policy for tokens encrypts it.
struct UserName {
    /// Name of a user of the server.
    std::string name;
    /// Password in UTF-8.
    std::string password;
};

/// Settings of a Client.
struct ClientOptions {
    /// Name that servers show for this client, also as the name of its session.
    std::string application_name = "metier client";
    /// ApplicationUri; not used with `security`.
    std::string application_uri = "urn:metier:client";
    std::optional<UserName> user{};  ///< none: anonymous
    /// Certificate of this client; none: connections without security. With it everything is signed
    /// and encrypted, the server's certificate must be trusted, and application_uri is taken from
    /// the certificate. A server's certificate that is not trusted is stored for a later decision.
    std::optional<Credentials> security{};
    /// Longest time that connect() may take, > 0.
    std::chrono::milliseconds connect_timeout{5'000};
    /// Silence after which the server may drop this session. Well before that the client sends a
    /// request, and gives the connection up if there is no answer. At least 2 s.
    std::chrono::milliseconds session_timeout{30'000};
    /// Longest time for every call without a timeout of its own, > 0.
    std::chrono::milliseconds call_timeout{5'000};
    /// Interval at which the server is asked to publish notifications, > 0; metier's servers
    /// publish events at once.
    std::chrono::milliseconds publishing_interval{100};
    /// Behaviour when the connection breaks; none: the connection is lost for good, make a new
    /// Client.
    std::optional<ReconnectOptions> reconnect{};
};

/// Longest time that one call may take; none: ClientOptions::call_timeout.
using Timeout = std::optional<std::chrono::milliseconds>;

/// The attributes of nodes (OPC 10000-3, 5; numbers of OPC 10000-6, A.1).
enum class AttributeId : std::uint32_t {
    /// NodeId.
    node_id = 1,
    /// Int32: a NodeClass.
    node_class = 2,
    /// QualifiedName.
    browse_name = 3,
    /// LocalizedText, in the server's language.
    display_name = 4,
    /// LocalizedText; many nodes have none.
    description = 5,
    /// Boolean, of types.
    is_abstract = 8,
    /// Byte, of Objects: bit 0 if clients may subscribe to events.
    event_notifier = 12,
    /// Value of a Variable.
    value = 13,
    /// NodeId of the type of the value.
    data_type = 14,
    /// Int32: -1 scalar, 1 one-dimensional array.
    value_rank = 15,
    /// UInt32[]: length of each dimension, 0: any.
    array_dimensions = 16,
    /// Byte, of Variables: bit 0 readable, bit 1 writable, for any user.
    access_level = 17,
    /// Byte: the same for this session's user.
    user_access_level = 18,
    /// Boolean, of Methods.
    executable = 21,
    /// Boolean: whether this session may call the Method now.
    user_executable = 22,
};

/// An attribute to read.
struct ReadItem {
    /// Node of the attribute.
    NodeId node;
    /// Attribute to read.
    AttributeId attribute = AttributeId::value;
};

/// A value to write.
struct WriteItem {
    /// Variable whose value is written.
    NodeId node;
    /// Value; its type must be that of the Variable.
    Value value;
    /// SourceTimestamp, by the writer's clock; none: not sent, the server takes its own.
    std::optional<UtcTime> source_time{};
    /// Value of Client::boot() when the NodeId was looked up, as MethodCall::boot.
    std::uint64_t boot = 0;
};

/// A Method to call, with its arguments.
struct MethodCall {
    /// Object on which the Method is called.
    NodeId object;
    /// Method node, of the Object or of its type.
    NodeId method;
    /// Input arguments, in order.
    std::vector<Value> inputs{};
    /// Value of Client::boot() when the NodeIds were looked up. If the server was started again
    /// since, the call is refused, as the NodeIds may name other nodes now. 0: sent in any case.
    std::uint64_t boot = 0;
};

/// Answer to a Method call that was not refused.
struct CallResult {
    /// Good or Uncertain.
    StatusCode status;
    /// Code for each input argument; may be empty.
    std::vector<StatusCode> input_results;
    /// Output arguments, in order; their number was not checked.
    std::vector<Value> outputs;
};

/// Selection of a node's references.
struct BrowseQuery {
    using Direction = BrowseDirection;

    /// Node whose references are read.
    NodeId node;
    /// Type of the references, with its subtypes; null: all.
    NodeId reference_type = ids::kHierarchicalReferences;
    /// Direction away from the node, or to it.
    Direction direction = Direction::forward;
    /// Node classes of the targets; empty: all.
    std::vector<NodeClass> node_classes{};
    /// Largest number per message; 0: as many as the server sends.
    std::uint32_t references_at_once = 0;
};

/// A path along hierarchical references.
struct RelativePath {
    /// Node at which the path begins.
    NodeId start;
    /// BrowseNames on the way, at least one.
    std::vector<QualifiedName> names;
};

/// Selection of events for a subscriber.
struct EventFilter {
    /// Fields of BaseEventType and its subtypes by BrowsePath, such as {{0, "Message"}} or {{0,
    /// "Transition"}, {0, "Number"}}; at least one. A server refuses a field that none of its event
    /// types has, and names it.
    std::vector<std::vector<QualifiedName>> fields;
    /// Type of the events, with its subtypes; none: all.
    std::optional<NodeId> of_type{};
    /// Number of events that the server may keep for us; it may keep fewer.
    std::uint32_t queue_size = 10'000;
};

/// Notification to a subscriber of events.
struct EventNotice {
    /// Kind of a notification to a subscriber of events.
    enum class Kind {
        /// An event: `fields` has a value per requested field, Null where the event has none.
        event,
        /// Events were lost in the server's queue or on the way.
        overflow,
        /// No further notification will come; `status` has the reason.
        ended,
        /// The connection is lost, `status` has the reason; `resumed` or `ended` follows.
        interrupted,
        /// Events come again. Events of the time between follow if the server kept them for this
        /// session; if not, `overflow` comes before.
        resumed,
    };

    /// Kind of this notification.
    Kind kind = Kind::event;
    /// Values in the order of EventFilter::fields; empty for the other kinds.
    std::vector<Value> fields;
    /// Reason, for `ended` and `interrupted`.
    StatusCode status;
};

/// Settings of a subscription to a Variable.
struct DataFilter {
    /// Interval at which the server looks for changes; 0: as fast as it can.
    std::chrono::milliseconds sampling_interval{100};
    /// Number of values that the server keeps between publications.
    std::uint32_t queue_size = 1;
};

/// Subscription to one node; it lasts as long as this object.
///
/// Once the destructor has returned, the callback does not run any more; the destructor waits at
/// most 5 s for a callback that is running. The server is informed later, and nothing waits for
/// that.
///
/// Threading: one owner; may be destroyed on any thread, in a callback too, and after its Client.
class Subscription {
public:
    /// A subscription to nothing.
    Subscription() = default;
    ~Subscription();
    Subscription(Subscription&& other) noexcept;
    Subscription& operator=(Subscription&& other) noexcept;

private:
    friend class Client;
    Subscription(std::shared_ptr<ClientCore> core, std::uint32_t handle);
    void end() noexcept;

    std::shared_ptr<ClientCore> core_;  // shared with the Client; the last one of them ends it
    std::uint32_t handle_ = 0;
};

/// One session with one OPC UA server; without ClientOptions::security over a connection of
/// SecurityPolicy None.
///
///     auto client = Client::connect("opc.tcp://127.0.0.1:4840");
///     if (!client) { ... client.error().message ... }
///     auto state = (*client)->read(NodeId::parse("i=2259").value());
///
/// Every call has a deadline, and a broken connection ends all calls at once. No request is sent
/// twice, after its deadline, or kept for later: without a connection a call fails at once.
///
/// With ClientOptions::reconnect it connects again by itself: to the same session if the server
/// still has it, else to a new one. Subscriptions continue or are made anew, with the namespace
/// indices of that time; the caller must look up all other NodeIds again when boot() has changed. A
/// connection is also given up when the server is silent: an idle server gets a request every 2 s,
/// or every third of the session time-out if that is less.
///
/// Errors of every call, besides those of the server: timeout (BadTimeout), connection_lost (also
/// after close()), invalid_state (a waiting call from a callback of this client),
/// resource_unavailable (2000 requests are unanswered). Failure::delivery says whether the request
/// left: after `unknown` a command may have been carried out, so ask before you repeat it.
///
/// Threading: any thread may call anything but the destructor, and many may at once. Waiting calls
/// block their thread. One thread of its own serves the connection and runs all callbacks, which
/// must neither wait nor throw. Callbacks may use the functions of this client that end in Async,
/// runAfter(), state() and the destructor of a Subscription; waiting calls and close() are refused
/// there.
class Client {
public:
    /// Connects and activates a session; waits, at most about ClientOptions::connect_timeout.
    /// \param url "opc.tcp://host:port"
    /// Errors: invalid_argument (the URL, a time that is not positive), connection_lost (no server
    ///         there), access_denied (user or password), timeout.
    static Answer<std::unique_ptr<Client>> connect(const std::string& url,
                                                   ClientOptions options = {});
    /// Closes the session. Must not run in a callback.
    ~Client();
    Client(const Client&) = delete;
    Client& operator=(const Client&) = delete;

    /// Ends the session within about a second, whatever the server does; pending calls fail with
    /// connection_lost. May be called again.
    /// Errors: invalid_state (from a callback).
    Answer<> close();

    /// State of the connection.
    enum class State {
        connected,     ///< a session is active
        reconnecting,  ///< broken; attempts go on, ClientOptions::reconnect
        lost,          ///< for good: whyLost()
        closed,        ///< by close()
    };
    /// Present state; any thread, does not wait.
    State state() const noexcept;
    /// Reason why there is no connection, or why the last one was lost; none: no connection was
    /// lost yet.
    std::optional<Failure> whyLost() const;
    /// Number of the server's run to which this client is connected: 1 for the first, one more
    /// whenever the server was started again. NodeIds are valid for one run only.
    std::uint64_t boot() const noexcept;
    /// Waits until it is connected.
    /// Errors: timeout at the deadline; connection_lost (given up, closed); invalid_state.
    Answer<> awaitConnected(SteadyTime deadline);

    /// Sets the callback for changes of the connection. It runs on the client's thread and must not
    /// wait. Not called after close(). A later callback replaces an earlier one.
    void onConnectionChange(std::function<void(const ConnectionChange&)> callback);

    /// Sets the callback for the final loss of the connection. It runs once, at once if the
    /// connection is lost already. Not called after close(). A later callback replaces an earlier
    /// one.
    void onConnectionLost(std::function<void(const Failure&)> callback);

    /// Runs `work` once on the client's thread after a delay, or when the client is closed before
    /// that. `work` must not wait. Callbacks may use it.
    /// \param delay negative: none
    /// Errors: connection_lost after close(), returned; then `work` is not run.
    Answer<> runAfter(std::chrono::nanoseconds delay, std::function<void()> work);

    /// Reads an attribute.
    /// Errors: the attribute's own StatusCode where Bad, such as not_found (BadNodeIdUnknown).
    Answer<Value> read(const NodeId& node, AttributeId attribute = AttributeId::value,
                       Timeout timeout = {});
    /// Reads attributes in one message; a server may refuse too many at once
    /// (ServerLimits::nodes_per_read of ours). One DataValue per item, in order, with its own
    /// StatusCode.
    Answer<std::vector<DataValue>> readMany(std::vector<ReadItem> items, Timeout timeout = {});

    /// Writes a Value.
    /// \param source_time by the writer's clock; none: the server takes its own
    /// Errors: the node's own StatusCode where Bad, such as out_of_range or locked.
    Answer<> write(NodeId node, Value value, std::optional<UtcTime> source_time = {},
                   Timeout timeout = {});
    /// Writes values in one message; a server may refuse too many at once. One StatusCode per item,
    /// in order.
    Answer<std::vector<StatusCode>> writeMany(std::vector<WriteItem> items, Timeout timeout = {});

    /// Calls a Method.
    /// Errors: the Method's own StatusCode where Bad, such as invalid_state; Failure::input_results
    /// has the codes of its arguments.
    Answer<CallResult> call(MethodCall method_call, Timeout timeout = {});
    /// The same for a NodeId that was looked up in this run of the server.
    Answer<CallResult> call(NodeId object, NodeId method, std::vector<Value> inputs = {});

    /// Reads all selected references, in as many messages as needed. References to nodes of other
    /// servers are left out.
    Answer<std::vector<Reference>> browse(BrowseQuery query, Timeout timeout = {});

    /// Looks up the node at the end of a path; the first one if there are several.
    /// Errors: not_found (BadNoMatch; BadNodeIdUnknown for the start).
    Answer<NodeId> translate(const NodeId& start, std::vector<QualifiedName> names,
                             Timeout timeout = {});
    /// Looks up the nodes at the ends of paths; an Answer per path, in order.
    Answer<std::vector<Answer<NodeId>>> translateMany(std::vector<RelativePath> paths,
                                                      Timeout timeout = {});

    /// Reads the server's NamespaceArray; nothing is cached.
    Answer<std::vector<std::string>> namespaceArray(Timeout timeout = {});
    /// Index of a namespace of the server.
    /// Errors: not_found.
    Answer<std::uint16_t> namespaceIndex(std::string_view uri, Timeout timeout = {});

    /// Whether this user may call the Method now. Errors: not_found.
    Answer<bool> readUserExecutable(const NodeId& method, Timeout timeout = {});

    /// Writes without waiting. `done` gets the outcome exactly once, at the latest at the deadline,
    /// on the client's thread. Writes are sent in the order of these calls.
    /// Errors: connection_lost, returned at once; then `done` is not called.
    Answer<> writeAsync(WriteItem item, std::function<void(Answer<>)> done, Timeout timeout = {});
    /// Writes several values in one request without waiting; as writeAsync(), `done` gets one
    /// StatusCode per item, in order.
    Answer<> writeManyAsync(std::vector<WriteItem> items,
                            std::function<void(Answer<std::vector<StatusCode>>)> done,
                            Timeout timeout = {});
    /// Reads without waiting; as writeAsync(), `done` gets one DataValue per item, in order.
    Answer<> readManyAsync(std::vector<ReadItem> items,
                           std::function<void(Answer<std::vector<DataValue>>)> done,
                           Timeout timeout = {});
    /// Calls a Method without waiting; as writeAsync().
    Answer<> callAsync(MethodCall method_call, std::function<void(Answer<CallResult>)> done,
                       Timeout timeout = {});

    /// Subscribes to the events of a notifier. The callback runs on the client's thread, possibly
    /// before this returns.
    /// Errors: those of the server; invalid_argument for a field or filter that it rejects.
    Answer<Subscription> subscribeEvents(NodeId notifier, EventFilter filter,
                                         std::function<void(const EventNotice&)> callback,
                                         Timeout timeout = {});
    /// Subscribes to changes of a Variable; its present value comes first. A lost value shows in
    /// the Overflow bit of the next StatusCode. When connection or Subscription end, an empty Value
    /// with a Bad status comes; it is the last notification unless the client reconnects. The
    /// callback runs on the client's thread, possibly before this returns.
    Answer<Subscription> subscribeData(NodeId variable, DataFilter filter,
                                       std::function<void(const DataValue&)> callback,
                                       Timeout timeout = {});

private:
    explicit Client(std::shared_ptr<ClientCore> core);
    template <typename Item>
    Answer<Subscription> subscribe(Item item, Timeout timeout);

    std::shared_ptr<ClientCore> core_;  // shared with its Subscriptions, which may end later
};

}  // namespace metier::opcua
