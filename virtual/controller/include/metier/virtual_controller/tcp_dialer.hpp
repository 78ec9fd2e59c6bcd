#pragma once

#include <asio/io_context.hpp>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "metier/base/error.hpp"
#include "metier/virtual_controller/link_faults.hpp"
#include "metier/virtual_controller/tcp_server.hpp"

namespace metier::virtual_controller {

/// TCP connection that a virtual controller opens itself.
///
/// Threading: made, used and destroyed on the thread that runs the io_context, whose handlers are
/// all called there.
///
///     auto dialer = TcpDialer::create(
///         context, {.from = "127.0.1.1", .to = "127.0.0.1", .port = 50002}, faults,
///         {.peer = {...}, .on_failed = [&](const Error& error) { ... }});
///     (*dialer)->dial();
class TcpDialer {
public:
    /// Both ends of the connection.
    struct Route {
        /// IP address of the controller; the peer sees it if both are loopback addresses.
        std::string from;
        /// IP address to connect to.
        std::string to;
        /// TCP port to connect to, > 0.
        std::uint16_t port{};
    };
    /// Functions that the dialer calls, on the thread of the io_context.
    struct Handlers {
        /// Handlers of the open connection.
        TcpServer::Handlers peer;
        /// Reports that no peer answered; the owner calls dial() again when it likes.
        std::function<void(const Error& error)> on_failed;
    };

    /// Creates the dialer; does not connect yet.
    /// \param faults must outlive the dialer
    /// Errors: invalid_argument (not an address, no port).
    static Result<std::unique_ptr<TcpDialer>> create(asio::io_context& context, const Route& route,
                                                     LinkFaults& faults, Handlers handlers);
    virtual ~TcpDialer() = default;

    /// Tries to connect once; peer.on_connected or on_failed follows. Fails while the cable is cut.
    /// Neither function is called from within dial().
    virtual void dial() = 0;
    /// Gives up dialling and resets an open connection.
    /// peer.on_closed follows for an open connection.
    virtual void reset() = 0;
};

}  // namespace metier::virtual_controller
