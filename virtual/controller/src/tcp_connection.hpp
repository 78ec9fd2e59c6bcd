#pragma once

#include <array>
#include <asio/ip/tcp.hpp>
#include <asio/steady_timer.hpp>
#include <cstddef>
#include <deque>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "metier/base/clock.hpp"
#include "metier/virtual_controller/tcp_server.hpp"
#include "open_connections.hpp"

namespace metier::virtual_controller {

class TcpConnection;

/// Owner of connections: a listening port, or a dialer.
class TcpConnectionOwner {
public:
    TcpConnectionOwner(LinkFaults& link_faults, TcpServer::Handlers what_to_do)
        : faults(link_faults), handlers(std::move(what_to_do)) {}
    TcpConnectionOwner(const TcpConnectionOwner&) = delete;
    TcpConnectionOwner& operator=(const TcpConnectionOwner&) = delete;

    LinkFaults& faults;
    const TcpServer::Handlers handlers;

    /// Makes a peer of a socket, reports it, and reads from it.
    void take(asio::ip::tcp::socket socket);
    /// A connection is lost.
    void remove(const TcpConnection* peer);
    void forEachPeer(const std::function<void(TcpPeer&)>& action);

protected:
    ~TcpConnectionOwner();

private:
    std::vector<std::shared_ptr<TcpConnection>> peers_;  // shared with their own operations
    OpenConnections* open_ = nullptr;                    // connections of the io_context; nullptr
                                                         // before the first
};

/// One connection. It keeps itself alive while an operation of it is under way.
class TcpConnection final : public TcpPeer, public std::enable_shared_from_this<TcpConnection> {
public:
    TcpConnection(TcpConnectionOwner& owner, asio::ip::tcp::socket socket, std::string address);

    using TcpPeer::send;
    void send(std::span<const std::byte> bytes) override;
    void close() override;
    void reset() override;
    std::size_t queued() const override { return queued_; }
    const std::string& address() const override { return address_; }

    void read();
    /// The owner is gone.
    void abandon();

private:
    struct Packet {
        SteadyTime due;
        std::vector<std::byte> bytes;
    };
    void onRead(const asio::error_code& error, std::size_t count);
    void write();
    void writeFront();
    void writeAt(SteadyTime until);
    void closeSocket();
    void lose();

    TcpConnectionOwner* owner_;
    asio::ip::tcp::socket socket_;
    asio::steady_timer write_timer_;
    asio::steady_timer read_timer_;
    std::string address_;
    std::array<std::byte, 16'384> incoming_{};
    std::deque<Packet> outgoing_;
    std::size_t queued_ = 0;
    bool writing_ = false;
    bool closing_ = false;
};

}  // namespace metier::virtual_controller
