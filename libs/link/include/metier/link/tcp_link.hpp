#pragma once

#include <asio/io_context.hpp>
#include <asio/ip/tcp.hpp>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "metier/base/clock.hpp"
#include "metier/base/error.hpp"

namespace metier::link {

/// A TCP connection on which every wait has a deadline. Small writes leave at once (TCP_NODELAY).
///
///     auto link = TcpLink::connect("10.0.0.5", 30004, deadline);
///     METIER_TRY(link->send(request, deadline));
///     METIER_TRY(link->receiveAll(header, deadline));
///
/// Error texts begin with the peer, such as "10.0.0.5:30004: ...". Sending and receiving do not
/// allocate unless there is an error. The connection ends with this object.
/// Threading: one thread sends and receives; shutdown() from any.
class TcpLink {
public:
    /// Connects to the first address of the host that answers; waits until the deadline at most,
    /// which all its addresses share.
    /// \param host a name or an IPv4 or IPv6 address
    /// Errors: connection_lost if there is no such host or nobody listens, timeout.
    static Result<TcpLink> connect(const std::string& host, std::uint16_t port,
                                   SteadyTime deadline);

    TcpLink(TcpLink&& other) noexcept = default;
    /// Ends the connection that was here before.
    TcpLink& operator=(TcpLink&& other) noexcept;
    ~TcpLink() = default;

    /// Waits for at least one byte and takes the bytes that are there, up to the buffer's size.
    /// Errors: timeout at the deadline, connection_lost if the peer closed or broke the connection.
    Result<std::size_t> receive(std::span<std::byte> buffer, SteadyTime deadline);
    /// Waits until the whole buffer is filled. Errors as receive(); received bytes are lost then.
    Result<void> receiveAll(std::span<std::byte> buffer, SteadyTime deadline);
    /// Hands all bytes to the system, in one write if the system takes them at once; waits until
    /// the deadline at most. After an error some of the bytes may have been sent.
    /// Errors: timeout if the peer does not read, connection_lost.
    Result<void> send(std::span<const std::byte> bytes, SteadyTime deadline);

    /// Ends both directions: a receive() that waits returns connection_lost. Idempotent.
    void shutdown() noexcept;
    /// File descriptor of the socket; the link keeps it and closes it.
    int descriptor();
    /// Address and port of the peer, such as "10.0.0.5:30004".
    const std::string& peer() const noexcept { return peer_; }

private:
    friend class TcpListener;
    TcpLink(std::unique_ptr<asio::io_context> context, asio::ip::tcp::socket socket,
            std::string peer);

    std::unique_ptr<asio::io_context> context_;  // context of the socket; must outlive it
    asio::ip::tcp::socket socket_;
    std::string peer_;
};

/// A TCP port that waits for peers to connect. It ends with this object; accepted links stay.
///
/// Threading: one thread; shutdown() from any.
class TcpListener {
public:
    /// Opens the port.
    /// \param address IP address of this machine
    /// \param port    0: a free one
    /// Errors: invalid_argument (not an address of this machine, or a port that this user may not
    ///         open), already_exists (port taken).
    static Result<TcpListener> listen(const std::string& address, std::uint16_t port);

    TcpListener(TcpListener&& other) noexcept = default;
    TcpListener& operator=(TcpListener&& other) noexcept;
    ~TcpListener() = default;

    /// Port on which it listens, also if a free one was chosen.
    std::uint16_t port() const;
    /// Waits for the next peer.
    /// Errors: timeout at the deadline, cancelled after shutdown().
    Result<TcpLink> accept(SteadyTime deadline);
    /// Closes the port: an accept() that waits returns cancelled. Idempotent.
    void shutdown() noexcept;

private:
    TcpListener(std::unique_ptr<asio::io_context> context, asio::ip::tcp::acceptor acceptor);

    std::unique_ptr<asio::io_context> context_;
    asio::ip::tcp::acceptor acceptor_;
};

}  // namespace metier::link
