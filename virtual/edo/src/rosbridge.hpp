#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "message_types.hpp"
#include "metier/base/clock.hpp"
#include "metier/base/error.hpp"

namespace metier::virtual_edo {

/// Topics and services on the robot's side of the bridge.
struct RosGraph {
    struct Service {
        std::string type;  ///< such as "edo_core_msgs/ControlSwitch"
        /// Gets whole arguments, answers with any part of the response.
        std::function<Result<Json>(const Json& arguments)> call;
    };

    std::map<std::string, std::string, std::less<>> topics;  ///< name to type
    std::map<std::string, Service, std::less<>> services;
    /// A client published a whole message on one of the topics.
    std::function<void(const std::string& topic, const Json& message)> on_message;
};

/// Adds the services of the node rosapi, by which clients look around: topics, services, types and
/// the time.
///
/// \param graph must stay at its address as long as it is served; entries added later are served,
/// too
/// Source: RobotWebTools/rosbridge_suite (ROS 1), rosapi/srv/*.srv and scripts/rosapi_node, which
///         rosbridge_websocket.launch starts.
void serveRosApi(RosGraph& graph, std::function<UtcTime()> now);

/// The rosbridge protocol, version 2, between clients and the robot: JSON in, JSON out, no sockets.
///
/// An error of a client is answered by an error status, and never harms another client.
///
/// Threading: one thread.
/// Source: RobotWebTools/rosbridge_suite, rosbridge_library (ROS 1); ROSBRIDGE_PROTOCOL.md.
class Rosbridge {
public:
    using Send = std::function<void(const std::string& text)>;
    using ClientId = std::uint64_t;

    /// Serves what the graph has, and /rosapi, by which clients look around in it.
    ///
    /// \param types   outlives the bridge
    /// \param started the robot's date when the time that setTime() counts is zero
    Rosbridge(const MessageTypes& types, RosGraph graph, UtcTime started = {});
    Rosbridge(const Rosbridge&) = delete;
    Rosbridge& operator=(const Rosbridge&) = delete;

    ClientId addClient(Send send);
    void removeClient(ClientId id);

    /// One text message of a client.
    void receive(ClientId id, std::string_view text);

    bool hasSubscribers(std::string_view topic) const;
    /// Gives a message, complete as its type is, to every client that subscribed.
    void publish(const std::string& topic, const Json& message);

    /// Sets the time by which throttle_rate counts; sends messages that waited in queues.
    void setTime(SteadyTime now);

private:
    struct SubscriptionWish {
        std::int64_t throttle_ms = 0;
        std::int64_t queue_length = 0;
    };
    struct Subscription {
        std::map<std::string, SubscriptionWish> wishes;  // wishes by their id
        std::optional<SteadyTime> last_sent;
        std::deque<std::string> queue;
        std::chrono::milliseconds throttle() const;
        std::size_t queueLength() const;
    };
    struct Client {
        Send send;
        int level = 1;  // level of status messages: 0 none, 1 error, 2 warning, 3 info
        std::optional<std::size_t> fragment_size;
        std::uint64_t fragments_sent = 0;
        std::map<std::string, Subscription, std::less<>> subscriptions;
        std::map<std::string, std::set<std::string>, std::less<>> advertised;  // topic to ids
        std::map<std::string, std::vector<std::optional<std::string>>> fragments;
    };
    using Operation = Result<void> (Rosbridge::*)(Client&, const Json&);

    Result<void> perform(Client& client, const Json& request);
    Result<void> advertise(Client& client, const Json& request);
    Result<void> unadvertise(Client& client, const Json& request);
    Result<void> publishFrom(Client& client, const Json& request);
    Result<void> subscribe(Client& client, const Json& request);
    Result<void> unsubscribe(Client& client, const Json& request);
    Result<void> callService(Client& client, const Json& request);
    Result<void> setLevel(Client& client, const Json& request);
    Result<void> takeFragment(Client& client, const Json& request);

    Result<Json> call(const std::string& service, const Json& arguments) const;
    Result<void> establish(const std::string& topic, const Json& request);
    void receiveFrom(Client& client, std::string_view text);
    void deliver(Client& client, Subscription& subscription, const std::string& text);
    void send(Client& client, const std::string& text);
    void sendStatus(Client& client, const std::string& text, const Json& request);

    const MessageTypes& types_;
    RosGraph graph_;
    std::map<ClientId, Client> clients_;
    ClientId last_id_ = 0;
    SteadyTime now_{};
};

}  // namespace metier::virtual_edo
