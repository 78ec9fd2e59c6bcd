#pragma once

#include <asio/io_context.hpp>
#include <asio/ip/address.hpp>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "metier/base/error.hpp"
#include "metier/virtual_controller/link_faults.hpp"

namespace metier::virtual_controller {

/// One peer of a TCP port. Owned by its server; a pointer to it is valid until the server has
/// called on_closed for it.
///
/// Threading: the thread that runs the io_context.
class TcpPeer {
public:
    virtual ~TcpPeer() = default;

    /// Queues bytes, which are sent in order; does not wait. A peer that leaves 1 MB unread is
    /// disconnected.
    virtual void send(std::span<const std::byte> bytes) = 0;
    /// The same for text.
    void send(std::string_view text) { send(std::as_bytes(std::span(text))); }
    /// Sends the queued bytes, then closes. on_closed follows.
    virtual void close() = 0;
    /// Closes at once with a reset, like a controller that lost power.
    virtual void reset() = 0;
    /// Number of queued bytes that the system has not taken yet.
    virtual std::size_t queued() const = 0;
    /// Address and port of the peer, such as "127.0.0.1:51234".
    virtual const std::string& address() const = 0;
};

/// Reads an IPv4 or IPv6 address. Threads: any; pure.
/// Errors: invalid_argument (not an address).
Result<asio::ip::address> parseAddress(const std::string& text);

/// A TCP port of a virtual controller:
///
///     auto port = TcpServer::listen(context, {"127.0.1.1", 30004}, faults,
///                                   {.on_data = [&](TcpPeer& peer, auto bytes) { ... }});
///
/// Threading: made, used and destroyed on the thread that runs the io_context, whose handlers are
/// all called there.
class TcpServer {
public:
    /// Functions that the server calls, on the thread of the io_context.
    struct Handlers {
        /// A peer has connected; it may be sent to at once.
        std::function<void(TcpPeer&)> on_connected;
        /// Receives the bytes of one read: part of a packet, or several packets.
        std::function<void(TcpPeer&, std::span<const std::byte>)> on_data;
        /// The peer is gone or was closed; the last call for it.
        std::function<void(TcpPeer&)> on_closed;
    };

    /// Place at which a server listens.
    struct Place {
        std::string address;     ///< of this machine; any 127.x.y.z is one
        std::uint16_t port = 0;  ///< 0: a free one
    };

    /// Opens the port.
    /// \param context must outlive the server
    /// \param faults  must outlive the server
    /// Errors: invalid_argument, already_exists (port taken), access_denied (port below 1024).
    static Result<std::unique_ptr<TcpServer>> listen(asio::io_context& context, const Place& place,
                                                     LinkFaults& faults, Handlers handlers);
    virtual ~TcpServer() = default;

    /// Port on which it listens, also if a free one was chosen.
    virtual std::uint16_t port() const = 0;
    /// Calls `action` for every connected peer.
    virtual void forEach(const std::function<void(TcpPeer&)>& action) = 0;
    /// Resets every connection, like a controller that restarts.
    virtual void resetAll() = 0;
};

}  // namespace metier::virtual_controller
