#include "metier/virtual_ur/script_sockets.hpp"

#include <array>
#include <asio/buffer.hpp>
#include <asio/ip/tcp.hpp>
#include <asio/steady_timer.hpp>
#include <asio/write.hpp>
#include <chrono>
#include <deque>
#include <utility>

namespace metier::virtual_ur {

namespace {

using asio::ip::tcp;
using urscript::SocketState;

constexpr std::size_t kMostUnread = 1'000'000;
constexpr std::size_t kMostUnsent = 1'000'000;
constexpr std::size_t kMostSockets = 64;
// A cut cable or a full buffer is looked at so often.
constexpr std::chrono::milliseconds kPause{4};

}  // namespace

class ScriptSockets::Socket : public std::enable_shared_from_this<Socket> {
public:
    Socket(asio::io_context& context, const virtual_controller::LinkFaults& faults)
        : faults_(faults), resolver_(context), socket_(context), pause_(context) {}

    void open(const std::string& from, const std::string& host, int port) {
        bind(from, host);
        resolver_.async_resolve(host, std::to_string(port),
                                [self = shared_from_this()](const asio::error_code& error,
                                                            const tcp::resolver::results_type& to) {
                                    self->onResolved(error, to);
                                });
    }
    void close() {
        asio::error_code ignored;
        state = SocketState::closed;
        resolver_.cancel();
        pause_.cancel();
        socket_.close(ignored);
    }
    bool send(std::string_view bytes) {
        if (state != SocketState::open || unsent_ + bytes.size() > kMostUnsent) {
            return false;
        }
        if (faults_.cut.load()) {
            return true;  // nobody is told
        }
        outgoing_.emplace_back(bytes);
        unsent_ += bytes.size();
        if (outgoing_.size() == 1) {
            write();
        }
        return true;
    }

    SocketState state = SocketState::opening;
    std::string unread;

private:
    void bind(const std::string& from, const std::string& host) {
        // From 127.a.b.c only the machine itself can be reached.
        asio::error_code error;
        const auto own = asio::ip::make_address(from, error);
        const bool here = host.starts_with("127.") || host == "localhost";
        if (!error && (!own.is_loopback() || here)) {
            socket_.open(tcp::endpoint(own, 0).protocol(), error);
            socket_.bind(tcp::endpoint(own, 0), error);
        }
    }
    void onResolved(const asio::error_code& error, const tcp::resolver::results_type& to) {
        if (error || to.empty() || state == SocketState::closed) {
            state = SocketState::closed;
            return;
        }
        socket_.async_connect(*to.begin(), [self = shared_from_this()](const auto& failed) {
            if (failed || self->state == SocketState::closed) {
                self->close();
                return;
            }
            asio::error_code ignored;
            self->socket_.set_option(tcp::no_delay(true), ignored);
            self->state = SocketState::open;
            self->read();
        });
    }
    void read() {
        if (unread.size() > kMostUnread || faults_.cut.load()) {
            pause_.expires_after(kPause);
            pause_.async_wait([self = shared_from_this()](const asio::error_code& error) {
                if (!error) {
                    self->read();
                }
            });
            return;
        }
        socket_.async_read_some(asio::buffer(incoming_.data(), incoming_.size()),
                                [self = shared_from_this()](const auto& error, std::size_t count) {
                                    if (error) {
                                        self->close();
                                        return;
                                    }
                                    if (!self->faults_.cut.load()) {
                                        self->unread.append(self->incoming_.data(), count);
                                    }
                                    self->read();
                                });
    }
    void write() {
        const auto& front = outgoing_.front();
        asio::async_write(socket_, asio::buffer(front.data(), front.size()),
                          [self = shared_from_this()](const auto& error, std::size_t) {
                              if (error) {
                                  self->close();
                                  return;
                              }
                              self->unsent_ -= self->outgoing_.front().size();
                              self->outgoing_.pop_front();
                              if (!self->outgoing_.empty()) {
                                  self->write();
                              }
                          });
    }

    const virtual_controller::LinkFaults& faults_;
    tcp::resolver resolver_;
    tcp::socket socket_;
    asio::steady_timer pause_;
    std::array<char, 4096> incoming_{};
    std::deque<std::string> outgoing_;
    std::size_t unsent_ = 0;
};

ScriptSockets::ScriptSockets(asio::io_context& context, std::string address,
                             const virtual_controller::LinkFaults& faults)
    : context_(context), address_(std::move(address)), faults_(faults) {}

ScriptSockets::~ScriptSockets() {
    closeAll();
}

ScriptSockets::Socket* ScriptSockets::find(const std::string& name) const {
    const auto found = sockets_.find(name);
    return found == sockets_.end() ? nullptr : found->second.get();
}

void ScriptSockets::open(const std::string& name, const std::string& host, int port) {
    close(name);
    if (sockets_.size() >= kMostSockets || port <= 0 || port > 65'535) {
        return;
    }
    auto socket = std::make_shared<Socket>(context_, faults_);
    sockets_[name] = socket;
    socket->open(address_, host, port);
}

SocketState ScriptSockets::state(const std::string& name) const {
    const auto* const socket = find(name);
    return socket == nullptr ? SocketState::closed : socket->state;
}

void ScriptSockets::close(const std::string& name) {
    if (auto* const socket = find(name)) {
        socket->close();
        sockets_.erase(name);
    }
}

bool ScriptSockets::send(const std::string& name, std::string_view bytes) {
    auto* const socket = find(name);
    return socket != nullptr && socket->send(bytes);
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
    for (const auto& [name, socket] : sockets_) {
        socket->close();
    }
    sockets_.clear();
}

}  // namespace metier::virtual_ur
