#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>

namespace metier::edo_driver::testing {

/// A websocket server on a free port of the loopback, for one client at a time.
///
/// Threading: `received` runs on the server's thread, and send() may be called from it or any
/// other.
class RosbridgeServer {
public:
    using Received = std::function<void(std::string_view text)>;
    using Tick = std::function<void()>;

    /// \param received called with each text of the client
    /// \param tick     called every `period` while a client is connected
    RosbridgeServer(Received received, Tick tick, std::chrono::milliseconds period);
    ~RosbridgeServer();
    RosbridgeServer(const RosbridgeServer&) = delete;
    RosbridgeServer& operator=(const RosbridgeServer&) = delete;

    std::uint16_t port() const;
    /// Nothing happens without a client.
    void send(std::string text);
    /// Sends a ping; waits for nothing.
    void ping();
    /// Ends the connection without a word; the client may come again.
    void drop();
    /// Number of times that a client connected.
    int connections() const;

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace metier::edo_driver::testing
