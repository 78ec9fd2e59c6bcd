#include "script_sockets.hpp"

#include <utility>

#include "metier/virtual_controller/tcp_dialer.hpp"

namespace metier::virtual_ur {

namespace {

using urscript::SocketState;
using virtual_controller::TcpDialer;
using virtual_controller::TcpPeer;

constexpr std::size_t kMostUnreadOfSocket = 1'000'000;
constexpr std::size_t kMostUnsent = 500'000;
constexpr std::size_t kMostSockets = 64;

}  // namespace

/// One socket. The dialer is the last member: its handlers use the others.
struct ScriptSockets::Socket {
    SocketState state = SocketState::opening;
    std::string unread;
    TcpPeer* peer = nullptr;
    std::unique_ptr<TcpDialer> dialer;

    void take(std::span<const std::byte> bytes) {
        unread.append(reinterpret_cast<const char*>(bytes.data()), bytes.size());  // NOLINT: text
        if (unread.size() > kMostUnreadOfSocket) {
            peer->reset();
        }
    }
    void lose() {
        peer = nullptr;
        state = SocketState::closed;
    }
};

ScriptSockets::ScriptSockets(asio::io_context& context, std::string address,
                             virtual_controller::LinkFaults& faults)
    : context_(context), address_(std::move(address)), faults_(faults) {}

ScriptSockets::~ScriptSockets() = default;

ScriptSockets::Socket* ScriptSockets::find(const std::string& name) const {
    const auto found = sockets_.find(name);
    return found == sockets_.end() ? nullptr : found->second.get();
}

void ScriptSockets::open(const std::string& name, const std::string& host, int port) {
    sockets_.erase(name);
    if (sockets_.size() >= kMostSockets || port <= 0 || port > 65'535) {
        return;
    }
    auto socket = std::make_unique<Socket>();
    auto* const own = socket.get();
    TcpDialer::Handlers handlers;
    handlers.peer.on_connected = [own](TcpPeer& peer) {
        own->peer = &peer;
        own->state = SocketState::open;
    };
    handlers.peer.on_data = [own](TcpPeer&, auto bytes) { own->take(bytes); };
    handlers.peer.on_closed = [own](TcpPeer&) { own->lose(); };
    handlers.on_failed = [own](const Error&) { own->lose(); };
    auto dialer = TcpDialer::create(
        context_,
        {address_, host == "localhost" ? "127.0.0.1" : host, static_cast<std::uint16_t>(port)},
        faults_, std::move(handlers));
    if (dialer) {
        socket->dialer = *std::move(dialer);
        socket->dialer->dial();
        sockets_[name] = std::move(socket);
    }
}

SocketState ScriptSockets::state(const std::string& name) const {
    const auto* const socket = find(name);
    return socket == nullptr ? SocketState::closed : socket->state;
}

void ScriptSockets::close(const std::string& name) {
    sockets_.erase(name);
}

bool ScriptSockets::send(const std::string& name, std::string_view bytes) {
    auto* const socket = find(name);
    if (socket == nullptr || socket->peer == nullptr || socket->peer->queued() > kMostUnsent) {
        return false;
    }
    socket->peer->send(bytes);
    return true;
}

std::string_view ScriptSockets::received(const std::string& name) const {
    const auto* const socket = find(name);
    return socket == nullptr ? std::string_view{} : socket->unread;
}

void ScriptSockets::consume(const std::string& name, std::size_t count) {
    if (auto* const socket = find(name)) {
        socket->unread.erase(0, count);
    }
}

void ScriptSockets::closeAll() {
    sockets_.clear();
}

}  // namespace metier::virtual_ur
