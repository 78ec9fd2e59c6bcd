#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

#include "metier/base/clock.hpp"
#include "metier/base/error.hpp"

namespace metier::edo_driver {

/// A WebSocket client (RFC 6455) for text messages; every wait has a deadline.
///
/// Error texts begin with the peer, such as "10.42.0.49:9090: ...". After connection_lost only
/// shutdown() and the destructor may be called. Pings of the server are answered while receive() or
/// send() waits.
/// Threading: one thread; shutdown() from any.
class WebSocketLink {
public:
    /// Connects and shakes hands; waits until the deadline at most.
    /// \param host a name or an address
    /// Errors: connection_lost (no such host, nobody listens, no websocket server), timeout.
    static Result<WebSocketLink> connect(const std::string& host, std::uint16_t port,
                                         SteadyTime deadline);

    WebSocketLink(WebSocketLink&&) noexcept;
    WebSocketLink& operator=(WebSocketLink&&) noexcept;
    ~WebSocketLink();

    /// Sends one message, in one write if the system takes it at once. Nothing allocates unless
    /// there is an error.
    /// Errors: timeout if the peer does not read (the link is unusable then), connection_lost.
    Result<void> send(std::string_view text, SteadyTime deadline);

    /// Waits for the next message; the view is valid until the next call. A message that has
    /// arrived in part at the deadline is not lost. Nothing allocates, unless there is an error or
    /// a message is longer than all before.
    /// Errors: timeout, connection_lost (also for a message over 1 MiB).
    Result<std::string_view> receive(SteadyTime deadline);

    /// Ends both directions: a receive() that waits returns connection_lost. Idempotent.
    void shutdown() noexcept;
    /// Address and port of the server: "10.42.0.49:9090".
    const std::string& peer() const noexcept;

private:
    struct Impl;
    explicit WebSocketLink(std::unique_ptr<Impl> impl);

    std::unique_ptr<Impl> impl_;
};

}  // namespace metier::edo_driver
