#pragma once

#include <asio/io_context.hpp>
#include <cstdint>
#include <map>
#include <memory>
#include <string>

#include "metier/virtual_controller/tcp_server.hpp"
#include "rosbridge.hpp"
#include "web_socket.hpp"

namespace metier::virtual_edo {

/// The port on which the bridge listens: a WebSocket for each client.
///
/// Threading: the thread that runs the io_context.
class BridgePort {
public:
    /// \param bridge and `faults` outlive the port
    /// Errors: as TcpServer::listen().
    static Result<std::unique_ptr<BridgePort>> open(asio::io_context& context,
                                                    const std::string& address, std::uint16_t port,
                                                    virtual_controller::LinkFaults& faults,
                                                    Rosbridge& bridge);
    BridgePort(const BridgePort&) = delete;
    BridgePort& operator=(const BridgePort&) = delete;
    ~BridgePort();

    /// Resets every connection.
    void disconnectAll();
    /// Connects new clients to `bridge` from now on; it must outlive the port.
    void serve(Rosbridge& bridge) { bridge_ = &bridge; }

    std::uint16_t port() const { return server_->port(); }
    std::size_t clients() const { return sessions_.size(); }

private:
    struct Session {
        WebSocket socket;
        Rosbridge::ClientId client = 0;  // 0: the handshake is not done
    };

    explicit BridgePort(Rosbridge& bridge) : bridge_(&bridge) {}
    void onData(virtual_controller::TcpPeer& peer, std::span<const std::byte> bytes);
    void onClosed(const virtual_controller::TcpPeer& peer);

    Rosbridge* bridge_;
    std::map<const virtual_controller::TcpPeer*, Session> sessions_;
    std::unique_ptr<virtual_controller::TcpServer> server_;
};

}  // namespace metier::virtual_edo
