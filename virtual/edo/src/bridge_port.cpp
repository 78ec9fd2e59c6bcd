#include "bridge_port.hpp"

#include <utility>

namespace metier::virtual_edo {

using virtual_controller::LinkFaults;
using virtual_controller::TcpPeer;
using virtual_controller::TcpServer;

Result<std::unique_ptr<BridgePort>> BridgePort::open(asio::io_context& context,
                                                     const std::string& address, std::uint16_t port,
                                                     LinkFaults& faults, Rosbridge& bridge) {
    std::unique_ptr<BridgePort> opened(new BridgePort(bridge));
    auto* const self = opened.get();
    auto server = TcpServer::listen(
        context, address, port, faults,
        {.on_connected = [self](TcpPeer& peer) { self->sessions_[&peer]; },
         .on_data = [self](TcpPeer& peer, auto bytes) { self->onData(peer, bytes); },
         .on_closed = [self](TcpPeer& peer) { self->onClosed(peer); }});
    if (!server) {
        return fail(server.error());
    }
    opened->server_ = std::move(*server);
    return opened;
}

BridgePort::~BridgePort() {
    for (const auto& [peer, session] : sessions_) {
        bridge_->removeClient(session.client);
    }
}

void BridgePort::disconnectAll() {
    for (auto& [peer, session] : sessions_) {
        bridge_->removeClient(std::exchange(session.client, 0));
        session.socket = WebSocket();
    }
    server_->resetAll();
}

void BridgePort::onData(TcpPeer& peer, std::span<const std::byte> bytes) {
    auto& session = sessions_[&peer];
    const auto received = session.socket.receive(bytes);
    peer.send(received.answer);
    if (session.client == 0 && session.socket.isOpen()) {
        session.client = bridge_->addClient(
            [&peer](const std::string& text) { peer.send(WebSocket::textFrame(text)); });
    }
    for (const auto& message : received.messages) {
        bridge_->receive(session.client, message);
    }
    if (received.close) {
        bridge_->removeClient(std::exchange(session.client, 0));
        peer.close();
    }
}

void BridgePort::onClosed(const TcpPeer& peer) {
    const auto session = sessions_.find(&peer);
    if (session != sessions_.end()) {
        bridge_->removeClient(session->second.client);
        sessions_.erase(session);
    }
}

}  // namespace metier::virtual_edo
