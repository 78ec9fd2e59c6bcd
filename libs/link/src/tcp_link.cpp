#include "metier/link/tcp_link.hpp"

#include <fmt/format.h>
#include <poll.h>

#include <asio/buffer.hpp>
#include <asio/error.hpp>
#include <utility>

#include "metier/link/host_addresses.hpp"
#include "poll_until.hpp"

namespace metier::link {
namespace {

using asio::ip::tcp;

/// Errors: timeout; connection_lost.
Result<void> connectTo(tcp::socket& socket, const tcp::endpoint& endpoint, SteadyTime deadline,
                       const std::string& name) {
    asio::error_code error;
    socket.open(endpoint.protocol(), error);
    socket.non_blocking(true, error);
    socket.connect(endpoint, error);
    if (error == asio::error::in_progress || error == asio::error::would_block) {
        METIER_TRY(pollUntil(socket.native_handle(), POLLOUT, deadline, name));
        int outcome = 0;
        socklen_t size = sizeof(outcome);
        getsockopt(socket.native_handle(), SOL_SOCKET, SO_ERROR, &outcome, &size);
        error = asio::error_code(outcome, asio::error::get_system_category());
    }
    if (error) {
        return fail(Errc::connection_lost, fmt::format("{}: {}", name, error.message()));
    }
    return {};
}

/// The same for each way in which a peer's end shows: with bytes that it has not read, it is a
/// reset.
Error lost(const std::string& peer, const asio::error_code& error) {
    const bool closed = error == asio::error::eof || error == asio::error::connection_reset ||
                        error == asio::error::broken_pipe;
    return {
        Errc::connection_lost,
        fmt::format("{}: {}", peer, closed ? "the peer closed the connection" : error.message())};
}

void sendAtOnce(tcp::socket& socket) {
    asio::error_code ignored;
    socket.non_blocking(true, ignored);
    socket.set_option(tcp::no_delay(true), ignored);
}

}  // namespace

TcpLink::TcpLink(std::unique_ptr<asio::io_context> context, tcp::socket socket, std::string peer)
    : context_(std::move(context)), socket_(std::move(socket)), peer_(std::move(peer)) {
    sendAtOnce(socket_);
}

TcpLink& TcpLink::operator=(TcpLink&& other) noexcept {
    socket_ = std::move(other.socket_);  // before the context of the one that was here ends
    context_ = std::move(other.context_);
    peer_ = std::move(other.peer_);
    return *this;
}

Result<TcpLink> TcpLink::connect(const std::string& host, std::uint16_t port, SteadyTime deadline) {
    auto name = fmt::format("{}:{}", host, port);
    const auto found = addressesOf(host, deadline);
    if (!found) {
        return fail(found.error().code, fmt::format("{}: {}", name, found.error().message));
    }
    auto context = std::make_unique<asio::io_context>();
    Error last{Errc::connection_lost, name + ": no such host"};
    for (const auto& address : *found) {
        tcp::socket socket(*context);
        const auto connected = connectTo(socket, {address, port}, deadline, name);
        if (connected) {
            return TcpLink(std::move(context), std::move(socket), std::move(name));
        }
        last = connected.error();
    }
    return fail(last);
}

Result<std::size_t> TcpLink::receive(std::span<std::byte> buffer, SteadyTime deadline) {
    for (;;) {
        asio::error_code error;
        const auto count = socket_.read_some(asio::buffer(buffer.data(), buffer.size()), error);
        if (!error) {
            return count;
        }
        if (error != asio::error::would_block && error != asio::error::interrupted) {
            return fail(lost(peer_, error));
        }
        METIER_TRY(pollUntil(socket_.native_handle(), POLLIN, deadline, peer_));
    }
}

Result<void> TcpLink::receiveAll(std::span<std::byte> buffer, SteadyTime deadline) {
    while (!buffer.empty()) {
        METIER_ASSIGN(const auto count, receive(buffer, deadline));
        buffer = buffer.subspan(count);
    }
    return {};
}

Result<void> TcpLink::send(std::span<const std::byte> bytes, SteadyTime deadline) {
    while (!bytes.empty()) {
        asio::error_code error;
        const auto count = socket_.write_some(asio::buffer(bytes.data(), bytes.size()), error);
        bytes = bytes.subspan(count);
        if (!error || error == asio::error::interrupted) {
            continue;
        }
        if (error != asio::error::would_block) {
            return fail(lost(peer_, error));
        }
        METIER_TRY(pollUntil(socket_.native_handle(), POLLOUT, deadline, peer_));
    }
    return {};
}

int TcpLink::descriptor() {
    return socket_.native_handle();
}

void TcpLink::shutdown() noexcept {
    // Not through Asio, whose socket is not for two threads at once.
    ::shutdown(socket_.native_handle(), SHUT_RDWR);
}

TcpListener::TcpListener(std::unique_ptr<asio::io_context> context, tcp::acceptor acceptor)
    : context_(std::move(context)), acceptor_(std::move(acceptor)) {}

TcpListener& TcpListener::operator=(TcpListener&& other) noexcept {
    acceptor_ = std::move(other.acceptor_);  // before the context of the one that was here ends
    context_ = std::move(other.context_);
    return *this;
}

Result<TcpListener> TcpListener::listen(const std::string& address, std::uint16_t port) {
    const auto name = fmt::format("{}:{}", address, port);
    asio::error_code error;
    const auto parsed = asio::ip::make_address(address, error);
    if (error) {
        return fail(Errc::invalid_argument, fmt::format("\"{}\" is not an address", address));
    }
    auto context = std::make_unique<asio::io_context>();
    tcp::acceptor acceptor(*context);
    const tcp::endpoint endpoint(parsed, port);
    acceptor.open(endpoint.protocol(), error);
    acceptor.set_option(tcp::acceptor::reuse_address(true), error);
    acceptor.bind(endpoint, error);
    if (!error) {
        acceptor.listen(tcp::acceptor::max_listen_connections, error);
    }
    if (error == asio::error::address_in_use) {
        return fail(Errc::already_exists, name + ": another program listens there");
    }
    if (error) {
        return fail(Errc::invalid_argument, name + ": " + error.message());
    }
    acceptor.non_blocking(true, error);
    return TcpListener(std::move(context), std::move(acceptor));
}

std::uint16_t TcpListener::port() const {
    asio::error_code ignored;
    return acceptor_.local_endpoint(ignored).port();
}

Result<TcpLink> TcpListener::accept(SteadyTime deadline) {
    for (;;) {
        auto context = std::make_unique<asio::io_context>();
        tcp::socket socket(*context);
        tcp::endpoint from;
        asio::error_code error;
        acceptor_.accept(socket, from, error);
        if (!error) {
            auto peer = fmt::format("{}:{}", from.address().to_string(), from.port());
            return TcpLink(std::move(context), std::move(socket), std::move(peer));
        }
        if (error == asio::error::invalid_argument) {
            return fail(Errc::cancelled, "the listener was shut down");
        }
        METIER_TRY(pollUntil(acceptor_.native_handle(), POLLIN, deadline, "nobody dialled in"));
    }
}

void TcpListener::shutdown() noexcept {
    ::shutdown(acceptor_.native_handle(), SHUT_RDWR);
}

}  // namespace metier::link
