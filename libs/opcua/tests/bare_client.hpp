#pragma once

#include <open62541/client.h>

#include <chrono>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "bare_filter.hpp"
#include "metier/opcua/event_emitter.hpp"
#include "metier/opcua/server.hpp"

namespace metier::opcua::testing {

using namespace std::chrono_literals;

inline constexpr auto kDeadline = 10s;

/// An event as a client got it: the values of the fields it selected.
using ReceivedEvent = std::vector<Value>;

/// A bare open62541 client, for tests of the server: it shares no code with ours but the values.
class BareClient {
public:
    BareClient();
    ~BareClient();
    BareClient(const BareClient&) = delete;
    BareClient& operator=(const BareClient&) = delete;

    StatusCode connect(const std::string& url);
    StatusCode connectAs(const std::string& user, const std::string& password,
                         const std::string& url);
    void disconnect();
    /// Closes the connection and leaves the session to its time-out.
    void breakConnection();
    /// Ends the session and leaves its Subscriptions to their lifetime.
    StatusCode closeSessionWithoutSubscriptions();
    /// Asks for the Subscription of another client. \return what the server says of it
    StatusCode takeSubscriptionOf(const BareClient& other);

    DataValue read(const NodeId& variable);
    /// Reads an attribute by its number.
    DataValue readAttribute(const NodeId& node, std::uint32_t attribute);
    std::optional<bool> readExecutable(const NodeId& method);
    std::optional<bool> readUserExecutable(const NodeId& method);
    StatusCode write(const NodeId& variable, const Value& value);
    /// With a StatusCode, also if it is Good.
    StatusCode writeWithStatus(const NodeId& variable, const Value& value, StatusCode quality);
    /// With a time of the client's own.
    StatusCode writeWithTime(const NodeId& variable, const Value& value, UtcTime source,
                             UtcTime server);
    /// Writes a part of an array: "1" or "0:1".
    StatusCode writePart(const NodeId& variable, const Value& value, const std::string& range);
    /// Writes so many zeros of Double, with these dimensions.
    StatusCode writeArray(const NodeId& variable, std::size_t length,
                          std::vector<std::uint32_t> dimensions);
    struct CallResult {
        StatusCode status;
        std::vector<Value> outputs;
    };
    CallResult call(const NodeId& object, const NodeId& method, const std::vector<Value>& inputs);
    StatusCode addFolder(const NodeId& parent);

    /// \return the publishing interval the server granted [ms], 0 if it refused
    double subscribe(double publishing_interval_ms);
    /// Selects fields of BaseEventType and its subtypes by path.
    StatusCode watchEvents(const NodeId& notifier, const std::vector<BrowsePath>& fields,
                           std::vector<ReceivedEvent>& into);
    /// Answer to an event filter.
    struct FilterResult {
        StatusCode status;
        std::vector<StatusCode> clauses;  ///< one per select clause if the filter is refused
        std::uint32_t item = 0;           ///< its MonitoredItemId if not
    };
    FilterResult watchEvents(const NodeId& notifier, BareFilter& filter,
                             std::vector<ReceivedEvent>& into);
    StatusCode watchValue(const NodeId& variable, double sampling_ms, std::vector<DataValue>& into);
    StatusCode watchAttribute(const NodeId& node, std::uint32_t attribute, double sampling_ms,
                              std::vector<DataValue>& into);
    /// Handles what comes until `done` or the deadline. \return done
    bool runUntil(const std::function<bool()>& done,
                  std::chrono::milliseconds deadline = kDeadline);

private:
    /// `item` needs all but the node and the attribute, which is Value.
    StatusCode writeItem(const NodeId& variable, UA_WriteValue item);

    UA_Client* client_ = nullptr;
    UA_UInt32 subscription_ = 0;
};

/// Options of a server for tests: a free port, two namespaces (2 and 3), and a silent log.
ServerOptions testOptions();
/// Made of testOptions(); fails the test's program if it cannot be.
std::unique_ptr<Server> makeServer(const ServerOptions& options = testOptions());

}  // namespace metier::opcua::testing
