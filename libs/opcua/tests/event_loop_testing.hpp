#pragma once

#include <open62541/client.h>
#include <open62541/client_config_default.h>
#include <open62541/client_highlevel.h>
#include <open62541/client_subscriptions.h>
#include <open62541/server.h>
#include <open62541/server_config_default.h>

#include <atomic>
#include <chrono>
#include <functional>
#include <future>
#include <memory>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "event_loop.hpp"

namespace metier::opcua::testing {

using namespace std::chrono_literals;

inline constexpr auto kDeadline = 10s;

enum class LoopKind { ours, stock };

/// A bare open62541 server in a thread of its own, on a port the system chose.
///
/// Its methods: `echo` returns its String; `fire` triggers an event on the Server object and asks
/// for publishing at once on every connection with an event MonitoredItem.
class TestServer {
public:
    struct Options {
        EventLoopOptions loop{};
        std::uint16_t port = 0;
        std::string host = "127.0.0.1";
        LoopKind kind = LoopKind::ours;
    };

    TestServer() : TestServer(Options{}) {}
    explicit TestServer(Options options);
    ~TestServer();
    TestServer(const TestServer&) = delete;
    TestServer& operator=(const TestServer&) = delete;

    /// Result of UA_Server_run_startup.
    UA_StatusCode started() const { return started_; }
    std::uint16_t port() const { return port_; }
    std::string url() const;
    AsioEventLoop& loop() { return *loop_; }

    /// Runs `work` on the server's thread and waits for it.
    template <typename Work>
    auto inServer(Work work) {
        std::packaged_task<decltype(work(std::declval<UA_Server*>()))()> task(
            [this, work] { return work(server_); });
        auto result = task.get_future();
        loop_->post([&task] { task(); });
        if (result.wait_for(kDeadline) != std::future_status::ready) {
            throw std::runtime_error("the server thread does not answer");
        }
        return result.get();
    }
    EventLoopStatistics statistics() {
        return inServer([this](UA_Server*) { return loop_->statistics(); });
    }
    /// Connection that called `echo` last; on the server's thread.
    ConnectionId lastCaller() const { return last_caller_; }
    /// On the server's thread: triggers an event and asks for publishing.
    void fire();
    /// On the server's thread: asks for publishing on every connection with an event item.
    void flushAll();

private:
    void run(const std::stop_token& stop);

    std::unique_ptr<AsioEventLoop> loop_;
    UA_Server* server_ = nullptr;
    std::set<ConnectionId> event_connections_;
    ConnectionId last_caller_ = 0;
    UA_StatusCode started_ = UA_STATUSCODE_GOOD;
    std::uint16_t port_ = 0;
    std::jthread thread_;

    friend struct TestServerCallbacks;
};

/// Number of Subscriptions that the server holds, on its thread.
std::size_t subscriptionCount(UA_Server* server);

/// A bare open62541 client, run by the test's thread.
class TestClient {
public:
    explicit TestClient(LoopKind kind = LoopKind::ours, EventLoopOptions options = {});
    ~TestClient();
    TestClient(const TestClient&) = delete;
    TestClient& operator=(const TestClient&) = delete;

    UA_Client* get() { return client_; }
    UA_StatusCode connect(const std::string& url);
    /// \return what the server answered; empty if it did not
    std::string echo(const std::string& text);
    /// Asks for an echo and does not wait for it.
    void askForEcho(const std::string& text);
    /// Calls `fire`. \return whether it went well
    bool fire();

    struct SubscriptionOptions {
        double publishing_interval_ms = 100;
        UA_UInt32 lifetime_count = 10000;
        UA_UInt32 keep_alive_count = 10;
        bool events = true;
    };
    UA_UInt32 subscribe(SubscriptionOptions options);
    /// Arrival times of the event notifications, in order.
    const std::vector<SteadyTime>& events() const { return events_; }
    std::size_t deleted() const { return deleted_; }
    /// Runs the client until `done`, at most kDeadline. \return whether it was
    bool runUntil(const std::function<bool()>& done);

private:
    std::unique_ptr<AsioEventLoop> loop_;
    UA_Client* client_ = nullptr;
    std::vector<SteadyTime> events_;
    std::size_t deleted_ = 0;
};

}  // namespace metier::opcua::testing
