#include "tcp_relay.hpp"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <stdexcept>
#include <utility>
#include <vector>

namespace metier::testing {

namespace {

constexpr std::size_t kMost = 65'536;  // [byte] moved at once

sockaddr_in loopback(std::uint16_t port) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(port);
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    return address;
}

const sockaddr* generic(const sockaddr_in& address) {
    return reinterpret_cast<const sockaddr*>(&address);
}

int newSocket() {
    const int descriptor = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    if (descriptor < 0) {
        throw std::runtime_error("no socket for the relay");
    }
    return descriptor;
}

int dial(std::uint16_t port) {
    const int descriptor = newSocket();
    const auto address = loopback(port);
    const int on = 1;
    ::setsockopt(descriptor, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
    if (::connect(descriptor, generic(address), sizeof address) != 0) {
        ::close(descriptor);
        return -1;
    }
    return descriptor;
}

/// Closed so that neither side waits for the other: a reset.
void reset(int descriptor) {
    const linger at_once{1, 0};
    ::setsockopt(descriptor, SOL_SOCKET, SO_LINGER, &at_once, sizeof at_once);
    ::close(descriptor);
}

bool sendAll(int descriptor, const std::string& bytes) {
    std::size_t sent = 0;
    while (sent < bytes.size()) {
        const auto count =
            ::send(descriptor, bytes.data() + sent, bytes.size() - sent, MSG_NOSIGNAL);
        if (count <= 0) {
            return false;
        }
        sent += static_cast<std::size_t>(count);
    }
    return true;
}

}  // namespace

TcpRelay::TcpRelay(std::uint16_t target)
    : target_(target), listener_(newSocket()), wake_(::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)) {
    auto address = loopback(0);
    socklen_t size = sizeof address;
    if (wake_ < 0 || ::bind(listener_, generic(address), size) != 0 ||
        ::listen(listener_, SOMAXCONN) != 0) {
        throw std::runtime_error("the relay cannot listen");
    }
    ::getsockname(listener_, reinterpret_cast<sockaddr*>(&address), &size);  // NOLINT(*-cast)
    port_ = ntohs(address.sin_port);
    thread_ = std::jthread([this] { run(); });
}

TcpRelay::~TcpRelay() {
    {
        const std::lock_guard lock(mutex_);
        stopping_ = true;
    }
    ::eventfd_write(wake_, 1);
    thread_.join();
    closeAll();
    ::close(listener_);
    ::close(wake_);
}

void TcpRelay::set(Mode mode) {
    const std::lock_guard lock(mutex_);
    mode_ = mode;
    if (mode == Mode::cut) {
        closeAll();
    }
    for (auto wire = wires_.begin(); wire != wires_.end();) {
        if (mode == Mode::pass && wire->second.damaged) {
            close(wire->second);
            wire = wires_.erase(wire);
        } else {
            ++wire;
        }
    }
    ::eventfd_write(wake_, 1);
}

void TcpRelay::pass() {
    set(Mode::pass);
}
void TcpRelay::cut() {
    set(Mode::cut);
}
void TcpRelay::stall() {
    set(Mode::stall);
}

void TcpRelay::interrupt() {
    const std::lock_guard lock(mutex_);
    mode_ = Mode::pass;
    closeAll();
    ::eventfd_write(wake_, 1);
}

std::string TcpRelay::sent() const {
    const std::lock_guard lock(mutex_);
    return sent_;
}

bool TcpRelay::inject(const std::string& bytes) {
    const std::lock_guard lock(mutex_);
    const auto wire = wires_.find(newest_);
    return wire != wires_.end() && sendAll(wire->second.server, bytes);
}

void TcpRelay::cutAt(std::string bytes, Moment moment) {
    const std::lock_guard lock(mutex_);
    trigger_ = std::move(bytes);
    moment_ = moment;
    triggered_ = false;
}

bool TcpRelay::awaitCut(SteadyTime deadline) {
    std::unique_lock lock(mutex_);
    return cut_.wait_until(lock, deadline, [this] { return triggered_; });
}

void TcpRelay::run() {
    for (;;) {
        std::vector<pollfd> polled{{wake_, POLLIN, 0}, {listener_, POLLIN, 0}};
        {
            const std::lock_guard lock(mutex_);
            for (const auto& [client, wire] : wires_) {
                polled.push_back({wire.client, POLLIN, 0});
                polled.push_back({wire.server, POLLIN, 0});
            }
        }
        ::poll(polled.data(), polled.size(), -1);
        const std::lock_guard lock(mutex_);
        if (stopping_) {
            return;
        }
        eventfd_t rung = 0;
        ::eventfd_read(wake_, &rung);
        if (polled[1].revents != 0) {
            accept();
        }
        for (std::size_t i = 2; i < polled.size(); ++i) {
            // Closed meanwhile, perhaps: the pair is looked up by the client's socket.
            const auto wire = wires_.find(polled[i - i % 2].fd);
            if (polled[i].revents != 0 && wire != wires_.end() &&
                !move(wire->second, polled[i].fd)) {
                close(wire->second);
                wires_.erase(wire);
            }
            if (mode_ == Mode::cut) {
                closeAll();
            }
        }
    }
}

void TcpRelay::accept() {
    const int client = ::accept4(listener_, nullptr, nullptr, SOCK_CLOEXEC);
    if (client < 0) {
        return;
    }
    const int server = mode_ == Mode::cut ? -1 : dial(target_);
    if (server < 0) {
        reset(client);
        return;
    }
    const int on = 1;
    ::setsockopt(client, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
    wires_[client] = {client, server, false};
    newest_ = client;
    sent_.clear();
}

/// Takes what has come from one end of a wire; false if that end is closed.
bool TcpRelay::move(Wire& wire, int from) {
    std::string bytes(kMost, '\0');
    const auto count = ::recv(from, bytes.data(), bytes.size(), MSG_DONTWAIT);
    if (count <= 0) {
        return count < 0 && (errno == EAGAIN || errno == EINTR);
    }
    bytes.resize(static_cast<std::size_t>(count));
    if (mode_ == Mode::stall) {
        wire.damaged = true;
        return true;
    }
    const bool must_cut = from == wire.client && mustCut(bytes);
    if (must_cut && moment_ == Moment::before) {
        mode_ = Mode::cut;
    } else if (!sendAll(from == wire.client ? wire.server : wire.client, bytes)) {
        return false;
    }
    if (wire.client == newest_ && from == newest_) {
        sent_ += bytes;
    }
    if (must_cut) {
        // Data that was sent to the server arrives, although the wire ends now.
        ::shutdown(wire.server, SHUT_WR);
        mode_ = Mode::cut;
        trigger_.clear();
        triggered_ = true;
        cut_.notify_all();
    }
    return true;
}

bool TcpRelay::mustCut(const std::string& bytes) const {
    return !trigger_.empty() && bytes.find(trigger_) != std::string::npos;
}

void TcpRelay::close(const Wire& wire) {
    reset(wire.client);
    ::close(wire.server);
}

void TcpRelay::closeAll() {
    for (const auto& [client, wire] : wires_) {
        close(wire);
    }
    wires_.clear();
}

}  // namespace metier::testing
