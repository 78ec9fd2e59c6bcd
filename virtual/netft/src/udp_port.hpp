#pragma once

#include <array>
#include <asio/io_context.hpp>
#include <asio/ip/udp.hpp>
#include <asio/steady_timer.hpp>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "metier/base/clock.hpp"
#include "metier/base/error.hpp"
#include "metier/virtual_controller/lifetime.hpp"
#include "metier/virtual_controller/link_faults.hpp"

namespace metier::virtual_netft {

/// A UDP port that obeys the faults of its cable.
///
/// Threading: made, used and destroyed on the thread that runs the io_context.
class UdpPort {
public:
    using Endpoint = asio::ip::udp::endpoint;
    using OnDatagram = std::function<void(const Endpoint& from, std::span<const std::byte>)>;

    /// \param port   0: a free one
    /// \param faults outlive the port
    /// Errors: invalid_argument, already_exists, access_denied.
    static Result<std::unique_ptr<UdpPort>> bind(asio::io_context& context, const Endpoint& local,
                                                 virtual_controller::LinkFaults& faults,
                                                 OnDatagram on_datagram);
    UdpPort(const UdpPort&) = delete;
    UdpPort& operator=(const UdpPort&) = delete;

    /// Datagrams beyond what may wait (10,000) are lost, as on a wire.
    void send(const Endpoint& to, std::vector<std::byte> datagram);
    std::uint16_t port() const;

private:
    struct Waiting {
        SteadyTime due;
        Endpoint to;
        std::vector<std::byte> bytes;
    };
    UdpPort(asio::ip::udp::socket socket, virtual_controller::LinkFaults& faults,
            OnDatagram on_datagram);
    void receive();
    void waitForDue();
    void sendNow(const Endpoint& to, std::span<const std::byte> bytes);

    asio::ip::udp::socket socket_;
    asio::steady_timer timer_;
    virtual_controller::LinkFaults& faults_;
    OnDatagram on_datagram_;
    std::array<std::byte, 2048> incoming_{};
    Endpoint from_;
    std::deque<Waiting> waiting_;
    virtual_controller::Lifetime lifetime_;
};

}  // namespace metier::virtual_netft
