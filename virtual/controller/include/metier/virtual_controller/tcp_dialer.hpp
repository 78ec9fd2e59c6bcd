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

/// The TCP connections that a virtual controller makes by itself.
///
/// Threading: made, used and destroyed on the thread that runs the io_context, whose handlers are
/// all called there.
class TcpDialer {
public:
    struct Route {
        std::string from;      ///< address of the controller; its peer sees it if both are loopback
        std::string to;        ///< address to dial
        std::uint16_t port{};  ///< > 0
    };
    struct Handlers {
        TcpServer::Handlers peer;
        /// Nobody answered; dial() again when it is time.
        std::function<void(const Error& error)> on_failed;
    };

    /// Does not dial yet.
    /// \param faults must outlive the dialer
    /// Errors: invalid_argument (not an address, no port).
    static Result<std::unique_ptr<TcpDialer>> create(asio::io_context& context, const Route& route,
                                                     LinkFaults& faults, Handlers handlers);
    virtual ~TcpDialer() = default;

    /// Tries once; peer.on_connected or on_failed follows. Over a cut cable nobody answers.
    virtual void dial() = 0;
    /// Gives up dialling and resets what is connected.
    virtual void reset() = 0;
};

}  // namespace metier::virtual_controller
