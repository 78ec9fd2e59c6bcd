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

/// A UDP socket for one peer: datagrams of others are not received. Every wait has a deadline.
///
/// Error texts begin with the peer, such as "10.0.0.5:49152: ...". Nothing allocates unless there
/// is an error.
/// Threading: one thread.
class UdpLink {
public:
    /// Opens the socket. Nothing is sent yet, so it is not known whether the peer exists.
    /// \param host a name or an address
    /// Errors: connection_lost if there is no such host; timeout if its name is not resolved in
    /// time.
    static Result<UdpLink> connect(const std::string& host, std::uint16_t port,
                                   SteadyTime deadline);

    UdpLink(UdpLink&& other) noexcept = default;
    UdpLink& operator=(UdpLink&& other) noexcept;
    ~UdpLink() = default;

    /// Waits for a datagram and takes it; bytes beyond the buffer's size are lost.
    /// Errors: timeout at the deadline, connection_lost if the peer's machine reports that nobody
    ///         listens there.
    Result<std::size_t> receive(std::span<std::byte> buffer, SteadyTime deadline);
    /// Sends one datagram; does not wait, and nothing shows whether it arrives.
    /// Errors: connection_lost.
    Result<void> send(std::span<const std::byte> bytes);

    /// Address and port of the peer, such as "10.0.0.5:49152".
    const std::string& peer() const noexcept { return peer_; }

private:
    UdpLink(std::unique_ptr<asio::io_context> context, asio::ip::udp::socket socket,
            std::string peer);

    std::unique_ptr<asio::io_context> context_;  // context of the socket; must outlive it
    asio::ip::udp::socket socket_;
    std::string peer_;
};

}  // namespace metier::link
