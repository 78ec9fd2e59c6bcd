#pragma once

#include <asio/io_context.hpp>
#include <asio/ip/udp.hpp>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "metier/base/clock.hpp"
#include "metier/base/error.hpp"

namespace metier::link {

/// A UDP socket that sends to one peer, hears nobody else, and waits with deadlines only.
///
/// Errors name the peer, as "10.0.0.5:49152: ...". Without an error nothing allocates.
/// Threading: one thread.
class UdpLink {
public:
    /// Nothing is sent yet, so whether anybody is there is not known.
    /// \param host a name or an address
    /// Errors: connection_lost if there is no such host; timeout if its name is not resolved in
    /// time.
    static Result<UdpLink> connect(const std::string& host, std::uint16_t port,
                                   SteadyTime deadline);

    UdpLink(UdpLink&& other) noexcept = default;
    UdpLink& operator=(UdpLink&& other) noexcept;
    ~UdpLink() = default;

    /// Waits for a datagram and takes it; what the buffer has no room for is lost.
    /// Errors: timeout at the deadline, connection_lost if the peer's machine says that nobody
    ///         listens there.
    Result<std::size_t> receive(std::span<std::byte> buffer, SteadyTime deadline);
    /// Sends one datagram. Errors: connection_lost.
    Result<void> send(std::span<const std::byte> bytes);

    /// "10.0.0.5:49152".
    const std::string& peer() const noexcept { return peer_; }

private:
    UdpLink(std::unique_ptr<asio::io_context> context, asio::ip::udp::socket socket,
            std::string peer);

    std::unique_ptr<asio::io_context> context_;  // the socket's, which outlives it
    asio::ip::udp::socket socket_;
    std::string peer_;
};

}  // namespace metier::link
