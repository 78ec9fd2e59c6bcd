#pragma once

#include <asio/ip/tcp.hpp>
#include <asio/steady_timer.hpp>
#include <memory>
#include <string>
#include <vector>

#include "connection.hpp"
#include "tcp_parameters.hpp"

namespace metier::opcua {

/// A socket that listens on one address.
///
/// It can be opened while connections of an earlier process on the same port still linger, and
/// never shares its port with another listening socket.
/// Threading: under the loop's mutex.
struct Listener {
    /// Closes the socket. The manager notifies the application later.
    void close();

    ConnectionId id;
    asio::ip::tcp::acceptor acceptor;
    Application application;
    ListenAddress address;
    asio::steady_timer timer{acceptor.get_executor()};  ///< pause before accepting is tried again
    bool closing = false;
};

struct OpenAcceptor {
    asio::ip::tcp::acceptor acceptor;
    ListenAddress address;
};

/// Opens what is to be listened on: every address (IPv4 and IPv6) of every name, or all
/// interfaces; on one port, also if 0 leaves its choice to the system. Resolving names may block.
/// Errors: already_exists (a port is taken), not_found (nothing could be listened on).
Result<std::vector<OpenAcceptor>> openAcceptors(asio::io_context& io,
                                                const TcpParameters& parameters);

}  // namespace metier::opcua
