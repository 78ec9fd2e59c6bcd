#include "metier/link/udp_link.hpp"

#include <fmt/format.h>
#include <poll.h>

#include <asio/buffer.hpp>
#include <asio/error.hpp>
#include <utility>

#include "metier/link/host_addresses.hpp"
#include "poll_until.hpp"

namespace metier::link {

using asio::ip::udp;

UdpLink::UdpLink(std::unique_ptr<asio::io_context> context, udp::socket socket, std::string peer)
    : context_(std::move(context)), socket_(std::move(socket)), peer_(std::move(peer)) {}

UdpLink& UdpLink::operator=(UdpLink&& other) noexcept {
    socket_ = std::move(other.socket_);  // before the context of the one that was here ends
    context_ = std::move(other.context_);
    peer_ = std::move(other.peer_);
    return *this;
}

Result<UdpLink> UdpLink::connect(const std::string& host, std::uint16_t port, SteadyTime deadline) {
    auto name = fmt::format("{}:{}", host, port);
    const auto found = addressesOf(host, deadline);
    if (!found) {
        return fail(found.error().code, fmt::format("{}: {}", name, found.error().message));
    }
    auto context = std::make_unique<asio::io_context>();
    asio::error_code error;
    udp::socket socket(*context);
    const udp::endpoint endpoint(found->front(), port);
    socket.open(endpoint.protocol(), error);
    if (!error) {
        socket.connect(endpoint, error);
    }
    if (!error) {
        socket.non_blocking(true, error);
    }
    if (error) {
        return fail(Errc::connection_lost, fmt::format("{}: {}", name, error.message()));
    }
    return UdpLink(std::move(context), std::move(socket), std::move(name));
}

Result<std::size_t> UdpLink::receive(std::span<std::byte> buffer, SteadyTime deadline) {
    for (;;) {
        asio::error_code error;
        const auto count = socket_.receive(asio::buffer(buffer.data(), buffer.size()), 0, error);
        if (!error) {
            return count;
        }
        if (error != asio::error::would_block && error != asio::error::interrupted) {
            return fail(Errc::connection_lost, fmt::format("{}: {}", peer_, error.message()));
        }
        METIER_TRY(pollUntil(socket_.native_handle(), POLLIN, deadline, peer_));
    }
}

Result<void> UdpLink::send(std::span<const std::byte> bytes) {
    asio::error_code error;
    socket_.send(asio::buffer(bytes.data(), bytes.size()), 0, error);
    if (error) {
        return fail(Errc::connection_lost, fmt::format("{}: {}", peer_, error.message()));
    }
    return {};
}

}  // namespace metier::link
