#include "metier/virtual_controller/tcp_server.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <asio/buffer.hpp>
#include <asio/ip/tcp.hpp>
#include <asio/steady_timer.hpp>
#include <asio/write.hpp>
#include <chrono>
#include <deque>
#include <utility>
#include <vector>

#include "metier/base/clock.hpp"

namespace metier::virtual_controller {
namespace {

using asio::ip::tcp;

constexpr std::size_t kLongestQueue = 1'000'000;
// A cut cable is looked at so often.
constexpr std::chrono::milliseconds kCutPause{10};

class Port;

/// One connection. It keeps itself alive while an operation of it is under way.
class Connection final : public TcpPeer, public std::enable_shared_from_this<Connection> {
public:
    Connection(Port& port, tcp::socket socket, std::string address);

    using TcpPeer::send;
    void send(std::span<const std::byte> bytes) override;
    void close() override;
    void reset() override;
    std::size_t queued() const override { return queued_; }
    const std::string& address() const override { return address_; }

    void read();
    /// The port is gone.
    void abandon();

private:
    struct Packet {
        SteadyTime due;
        std::vector<std::byte> bytes;
    };
    void onRead(const asio::error_code& error, std::size_t count);
    void write();
    void writeFront();
    void wait(SteadyTime until, void (Connection::*then)());
    void closeSocket();
    void lose();

    Port* port_;
    tcp::socket socket_;
    asio::steady_timer write_timer_;
    asio::steady_timer read_timer_;
    std::string address_;
    std::array<std::byte, 16'384> incoming_{};
    std::deque<Packet> outgoing_;
    std::size_t queued_ = 0;
    bool writing_ = false;
    bool closing_ = false;
};

class Port final : public TcpServer {
public:
    Port(tcp::acceptor acceptor, LinkFaults& link_faults, Handlers what_to_do)
        : faults(link_faults), handlers(std::move(what_to_do)), acceptor_(std::move(acceptor)) {
        accept();
    }
    ~Port() override {
        for (const auto& peer : peers_) {
            peer->abandon();
        }
    }

    std::uint16_t port() const override {
        asio::error_code ignored;
        return acceptor_.local_endpoint(ignored).port();
    }
    void forEach(const std::function<void(TcpPeer&)>& action) override {
        const auto peers = peers_;  // an action may close one
        for (const auto& peer : peers) {
            action(*peer);
        }
    }
    void resetAll() override {
        forEach([](TcpPeer& peer) { peer.reset(); });
    }
    void remove(const Connection* peer) {
        const auto found = std::find_if(peers_.begin(), peers_.end(),
                                        [&](const auto& known) { return known.get() == peer; });
        if (found != peers_.end()) {
            const auto kept = *found;  // until the handler returns
            peers_.erase(found);
            if (handlers.on_closed) {
                handlers.on_closed(*kept);
            }
        }
    }

    LinkFaults& faults;
    const Handlers handlers;

private:
    void accept() {
        acceptor_.async_accept([this](const asio::error_code& error, tcp::socket socket) {
            if (error == asio::error::operation_aborted) {
                return;
            }
            if (!error) {
                take(std::move(socket));
            }
            accept();
        });
    }
    void take(tcp::socket socket) {
        if (faults.cut.load()) {
            unreachable_.push_back(std::move(socket));
            return;
        }
        unreachable_.clear();
        asio::error_code error;
        const auto from = socket.remote_endpoint(error);
        if (error) {
            return;
        }
        socket.set_option(tcp::no_delay(true), error);
        auto peer = std::make_shared<Connection>(
            *this, std::move(socket),
            fmt::format("{}:{}", from.address().to_string(), from.port()));
        peers_.push_back(peer);
        if (handlers.on_connected) {
            handlers.on_connected(*peer);
        }
        peer->read();
    }

    tcp::acceptor acceptor_;
    std::vector<tcp::socket> unreachable_;  // dialled over a cut cable; never get an answer
    std::vector<std::shared_ptr<Connection>> peers_;  // shared with their own operations
};

Connection::Connection(Port& port, tcp::socket socket, std::string address)
    : port_(&port),
      socket_(std::move(socket)),
      write_timer_(socket_.get_executor()),
      read_timer_(socket_.get_executor()),
      address_(std::move(address)) {}

void Connection::send(std::span<const std::byte> bytes) {
    if (closing_ || port_ == nullptr || bytes.empty()) {
        return;
    }
    auto& faults = port_->faults;
    if (queued_ + bytes.size() > kLongestQueue) {
        if (!faults.cut.load()) {
            reset();
        }
        return;
    }
    const auto delay = std::chrono::milliseconds(faults.delay_ms.load());
    outgoing_.push_back({std::chrono::steady_clock::now() + delay, {bytes.begin(), bytes.end()}});
    queued_ += bytes.size();
    auto left = faults.garble.load();
    if (left > 0) {
        faults.garble.compare_exchange_strong(left, left - 1);
        auto& garbled = outgoing_.back().bytes;
        garbled[garbled.size() / 2] ^= std::byte{0x55};
    }
    write();
}

void Connection::wait(SteadyTime until, void (Connection::*then)()) {
    write_timer_.expires_at(until);
    write_timer_.async_wait([self = shared_from_this(), then](const asio::error_code& error) {
        self->writing_ = false;
        if (!error) {
            (self.get()->*then)();
        }
    });
}

void Connection::write() {
    if (writing_ || port_ == nullptr) {
        return;
    }
    if (outgoing_.empty()) {
        if (closing_) {
            lose();
        }
        return;
    }
    writing_ = true;
    const auto now = std::chrono::steady_clock::now();
    if (port_->faults.cut.load()) {
        wait(now + kCutPause, &Connection::write);
    } else if (outgoing_.front().due > now) {
        wait(outgoing_.front().due, &Connection::write);
    } else {
        writeFront();
    }
}

void Connection::writeFront() {
    const auto& bytes = outgoing_.front().bytes;
    asio::async_write(socket_, asio::buffer(bytes.data(), bytes.size()),
                      [self = shared_from_this()](const asio::error_code& error, std::size_t) {
                          self->writing_ = false;
                          if (error) {
                              self->lose();
                              return;
                          }
                          self->queued_ -= self->outgoing_.front().bytes.size();
                          self->outgoing_.pop_front();
                          self->write();
                      });
}

void Connection::read() {
    if (port_ == nullptr) {
        return;
    }
    if (port_->faults.cut.load()) {
        read_timer_.expires_after(kCutPause);
        read_timer_.async_wait([self = shared_from_this()](const asio::error_code& error) {
            if (!error) {
                self->read();
            }
        });
        return;
    }
    socket_.async_read_some(
        asio::buffer(incoming_.data(), incoming_.size()),
        [self = shared_from_this()](const asio::error_code& error, std::size_t count) {
            self->onRead(error, count);
        });
}

void Connection::onRead(const asio::error_code& error, std::size_t count) {
    if (error) {
        lose();
        return;
    }
    if (port_ == nullptr) {
        return;
    }
    // What comes over a cut cable is lost.
    if (!port_->faults.cut.load() && port_->handlers.on_data) {
        port_->handlers.on_data(*this, std::span(incoming_).first(count));
    }
    if (socket_.is_open()) {
        read();
    }
}

void Connection::close() {
    closing_ = true;
    if (!writing_ && outgoing_.empty()) {
        // Not from within a handler of this peer's own data.
        asio::post(socket_.get_executor(), [self = shared_from_this()] { self->lose(); });
    }
}

void Connection::reset() {
    asio::error_code ignored;
    socket_.set_option(asio::socket_base::linger(true, 0), ignored);
    closing_ = true;
    closeSocket();
    asio::post(socket_.get_executor(), [self = shared_from_this()] { self->lose(); });
}

void Connection::abandon() {
    port_ = nullptr;
    closeSocket();
}

void Connection::closeSocket() {
    asio::error_code ignored;
    socket_.close(ignored);
    write_timer_.cancel();
    read_timer_.cancel();
}

void Connection::lose() {
    closeSocket();
    if (auto* port = std::exchange(port_, nullptr)) {
        port->remove(this);
    }
}

}  // namespace

Result<std::unique_ptr<TcpServer>> TcpServer::listen(asio::io_context& context,
                                                     const std::string& address, std::uint16_t port,
                                                     LinkFaults& faults, Handlers handlers) {
    const auto name = fmt::format("{}:{}", address, port);
    asio::error_code error;
    const auto parsed = asio::ip::make_address(address, error);
    if (error) {
        return fail(Errc::invalid_argument, fmt::format("\"{}\" is not an address", address));
    }
    tcp::acceptor acceptor(context);
    acceptor.open(tcp::endpoint(parsed, port).protocol(), error);
    acceptor.set_option(tcp::acceptor::reuse_address(true), error);
    acceptor.bind(tcp::endpoint(parsed, port), error);
    if (!error) {
        acceptor.listen(tcp::acceptor::max_listen_connections, error);
    }
    if (error == asio::error::address_in_use) {
        return fail(Errc::already_exists, name + ": another program listens there");
    }
    if (error == asio::error::access_denied) {
        return fail(Errc::access_denied, name + ": ports below 1024 need root");
    }
    if (error) {
        return fail(Errc::invalid_argument, name + ": " + error.message());
    }
    return std::make_unique<Port>(std::move(acceptor), faults, std::move(handlers));
}

}  // namespace metier::virtual_controller
