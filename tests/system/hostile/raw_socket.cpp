#include "raw_socket.hpp"

#include <arpa/inet.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <stdexcept>
#include <utility>

namespace metier::hostile {

namespace {

sockaddr_in loopback(std::uint16_t port) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(port);
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    return address;
}

/// The form that the system's functions take.
sockaddr* generic(sockaddr_in& address) {
    return reinterpret_cast<sockaddr*>(&address);
}

bool becomes(int descriptor, short events, std::chrono::milliseconds longest) {
    pollfd watched{descriptor, events, 0};
    return ::poll(&watched, 1, static_cast<int>(longest.count())) > 0;
}

}  // namespace

RawSocket::RawSocket(int descriptor) {
    takeOver(descriptor);
}

RawSocket::RawSocket(RawSocket&& other) noexcept
    : descriptor_(std::exchange(other.descriptor_, -1)) {}

RawSocket& RawSocket::operator=(RawSocket&& other) noexcept {
    if (this != &other) {
        reset();
        descriptor_ = std::exchange(other.descriptor_, -1);
    }
    return *this;
}

void RawSocket::takeOver(int descriptor) {
    const int on = 1;
    ::setsockopt(descriptor, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
    ::fcntl(descriptor, F_SETFL, O_NONBLOCK);  // NOLINT(*-vararg): the system's function
    descriptor_ = descriptor;
}

bool RawSocket::connect(std::uint16_t port) {
    reset();
    const int descriptor = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    auto address = loopback(port);
    if (::connect(descriptor, generic(address), sizeof address) != 0) {
        ::close(descriptor);
        return false;
    }
    takeOver(descriptor);
    return true;
}

void RawSocket::reset() {
    if (descriptor_ < 0) {
        return;
    }
    const linger at_once{1, 0};
    ::setsockopt(descriptor_, SOL_SOCKET, SO_LINGER, &at_once, sizeof at_once);
    ::close(std::exchange(descriptor_, -1));
}

bool RawSocket::wait(short events, std::chrono::milliseconds longest) const {
    return becomes(descriptor_, events, longest);
}

void RawSocket::send(std::string_view bytes, std::chrono::milliseconds longest) {
    while (!bytes.empty() && isOpen()) {
        const auto sent = ::send(descriptor_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
        if (sent > 0) {
            bytes.remove_prefix(static_cast<std::size_t>(sent));
        } else if (errno != EAGAIN || !wait(POLLOUT, longest)) {
            reset();
        }
    }
}

void RawSocket::endSending() {
    ::shutdown(descriptor_, SHUT_WR);
}

void RawSocket::receive(std::string& into, std::chrono::milliseconds longest) {
    std::array<char, 65'536> buffer;  // NOLINT(*-member-init): filled by recv
    if (longest.count() > 0 && isOpen()) {
        wait(POLLIN, longest);
    }
    while (isOpen()) {
        const auto got = ::recv(descriptor_, buffer.data(), buffer.size(), 0);
        if (got > 0) {
            into.append(buffer.data(), static_cast<std::size_t>(got));
        } else if (got < 0 && errno == EAGAIN) {
            return;
        } else {
            reset();
        }
    }
}

RawListener::RawListener() : descriptor_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    auto address = loopback(0);
    socklen_t size = sizeof address;
    if (::bind(descriptor_, generic(address), size) != 0 || ::listen(descriptor_, SOMAXCONN) != 0 ||
        ::getsockname(descriptor_, generic(address), &size) != 0) {
        throw std::runtime_error("no port to listen on");
    }
    port_ = ntohs(address.sin_port);
}

RawListener::~RawListener() {
    ::close(descriptor_);
}

RawSocket RawListener::accept(std::chrono::milliseconds longest) const {
    if (!becomes(descriptor_, POLLIN, longest)) {
        return {};
    }
    const int connected = ::accept4(descriptor_, nullptr, nullptr, SOCK_CLOEXEC);
    return connected < 0 ? RawSocket() : RawSocket(connected);
}

}  // namespace metier::hostile
