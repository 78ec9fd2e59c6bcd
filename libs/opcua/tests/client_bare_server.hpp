#pragma once

#include <open62541/server.h>

#include <chrono>
#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

#include "event_loop.hpp"
#include "metier/opcua/client.hpp"

namespace metier::opcua::testing {

struct BareServerOptions {
    std::uint16_t port = 0;  ///< 0: a free one
    std::string password = "password";
    int many = 50;              ///< variables in `Many`
    int namespaces_before = 0;  ///< namespaces of no use before that of `Moving`
};

/// A server of the stack alone, for tests of the client, with these nodes in namespace 1:
/// `Number` (Double, 1.5), `ReadOnly` (Double), `Holder` (object, an event notifier) with the
/// methods `Add` (Double, Double -> Double), `Refuse` (BadInvalidState), `Raise` (UInt32: that many
/// events with the messages 1, 2, ...) and `Many` (folder of variables `0`, `1`, ...); and
/// `Moving` (Double, 1.5) in namespace kMovingUri. `user1` may log in with the password, and
/// anybody.
class BareServer {
public:
    explicit BareServer(const BareServerOptions& options = {});
    /// Stops it: all connections are closed.
    ~BareServer();
    BareServer(const BareServer&) = delete;
    BareServer& operator=(const BareServer&) = delete;

    std::string url() const { return url_; }
    std::uint16_t port() const { return port_; }
    /// From now on it answers nothing and its connections stay open, until resume().
    void pause();
    void resume();
    /// Runs work in the server's thread and waits for it.
    void run(const std::function<void(UA_Server*)>& work);
    /// Events of this size of queue at most, for MonitoredItems made from here on.
    void limitQueues(std::uint32_t length);

private:
    void addNodes(const BareServerOptions& options);

    AsioEventLoop loop_;
    UA_Server* server_;
    std::string url_;
    std::uint16_t port_ = 0;
    std::mutex mutex_;
    std::condition_variable resumed_;
    bool paused_ = false;
    std::jthread thread_;
};

/// Takes connections and says nothing.
class MuteListener {
public:
    MuteListener();
    ~MuteListener();
    MuteListener(const MuteListener&) = delete;
    MuteListener& operator=(const MuteListener&) = delete;
    std::string url() const;

private:
    int socket_;
};

inline const NodeId kNumber{1, "Number"};
inline const NodeId kReadOnly{1, "ReadOnly"};
inline const NodeId kHolder{1, "Holder"};
inline const NodeId kAdd{1, "Add"};
inline const NodeId kRefuse{1, "Refuse"};
inline const NodeId kRaise{1, "Raise"};
inline const NodeId kMany{1, "Many"};
inline constexpr const char* kMovingUri = "urn:metier:test:moving";
inline constexpr const char* kMoving = "Moving";

/// A client connected to the server; fails the test if it cannot.
std::unique_ptr<Client> connected(const std::string& url, ClientOptions options = {});

/// Waits until a condition holds that other threads bring about.
class Condition {
public:
    void notify(const std::function<void()>& change);
    /// Whether it held within the time.
    bool wait(const std::function<bool()>& holds,
              std::chrono::milliseconds longest = std::chrono::seconds(30));

private:
    std::mutex mutex_;
    std::condition_variable changed_;
};

}  // namespace metier::opcua::testing
