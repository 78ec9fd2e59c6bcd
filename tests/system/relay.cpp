#include "relay.hpp"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <system_error>
#include <utility>

namespace metier::system_tests {

namespace {

constexpr int kPatienceS = 30;

int orThrow(int outcome, const char* doing) {
    if (outcome < 0) {
        throw std::system_error(errno, std::generic_category(), doing);
    }
    return outcome;
}

sockaddr_in loopback(std::uint16_t port) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(port);
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    return address;
}

/// The socket functions take any kind of address by its first part.
template <typename Call>
int withAddress(sockaddr_in& address, Call call) {
    return call(reinterpret_cast<sockaddr*>(&address));  // NOLINT(*-reinterpret-cast)
}

int newSocket() {
    const int handle = orThrow(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0), "socket");
    const int on = 1;
    orThrow(::setsockopt(handle, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on), "TCP_NODELAY");
    return handle;
}

int connectTo(std::uint16_t port) {
    const int handle = newSocket();
    auto address = loopback(port);
    orThrow(
        withAddress(address, [&](sockaddr* to) { return ::connect(handle, to, sizeof address); }),
        "connect");
    return handle;
}

bool sendAll(int handle, const char* data, std::size_t size) {
    while (size > 0) {
        const auto sent = ::send(handle, data, size, MSG_NOSIGNAL);
        if (sent <= 0) {
            return false;
        }
        data += sent;
        size -= static_cast<std::size_t>(sent);
    }
    return true;
}

void closeHandle(int& handle) {
    if (handle >= 0) {
        ::close(std::exchange(handle, -1));
    }
}

}  // namespace

Relay::Relay(std::uint16_t server_port)
    : server_port_(server_port),
      listener_(newSocket()),
      wake_(orThrow(::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK), "eventfd")) {
    auto address = loopback(0);
    socklen_t size = sizeof address;
    orThrow(withAddress(address, [&](sockaddr* at) { return ::bind(listener_, at, size); }),
            "bind");
    orThrow(::listen(listener_, 1), "listen");
    orThrow(withAddress(address, [&](sockaddr* at) { return ::getsockname(listener_, at, &size); }),
            "getsockname");
    port_ = ntohs(address.sin_port);
    thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
}

Relay::~Relay() {
    thread_.request_stop();
    wake();
    thread_.join();
    closeBoth();
    closeHandle(listener_);
    closeHandle(wake_);
}

std::string Relay::url() const {
    return fmt::format("opc.tcp://127.0.0.1:{}", port_);
}

void Relay::wake() const {
    const std::uint64_t one = 1;
    static_cast<void>(::write(wake_, &one, sizeof one));
}

void Relay::cut() {
    const std::lock_guard lock(mutex_);
    closeHandle(client_);
    closeHandle(server_);
    cut_ = true;
    wake();
}

Bytes Relay::sent() const {
    const std::lock_guard lock(mutex_);
    return sent_;
}

bool Relay::inject(const Bytes& bytes) {
    const std::lock_guard lock(mutex_);
    return server_ >= 0 && sendAll(server_, bytes.data(), bytes.size());
}

void Relay::closeBoth() {
    closeHandle(client_);
    closeHandle(server_);
}

void Relay::run(const std::stop_token& stop) {
    while (!stop.stop_requested()) {
        std::array<pollfd, 4> waited{};
        {
            const std::lock_guard lock(mutex_);
            waited = {pollfd{wake_, POLLIN, 0}, pollfd{listener_, POLLIN, 0},
                      pollfd{client_, POLLIN, 0}, pollfd{server_, POLLIN, 0}};
        }
        if (::poll(waited.data(), waited.size(), kPatienceS * 1'000) <= 0) {
            continue;
        }
        std::uint64_t count = 0;
        static_cast<void>(::read(wake_, &count, sizeof count));
        const std::lock_guard lock(mutex_);
        if (std::exchange(cut_, false)) {
            continue;  // the handles are others by now
        }
        if (waited[1].revents != 0) {
            accept();
            continue;
        }
        if (waited[2].revents != 0) {
            forward(client_, server_);
        }
        if (waited[3].revents != 0 && server_ >= 0) {
            forward(server_, client_);
        }
    }
}

/// A new client takes the place of the one before.
void Relay::accept() {
    closeBoth();
    client_ = ::accept4(listener_, nullptr, nullptr, SOCK_CLOEXEC);
    if (client_ < 0) {
        return;
    }
    const int on = 1;
    static_cast<void>(::setsockopt(client_, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on));
    sent_.clear();
    try {
        server_ = connectTo(server_port_);
    } catch (const std::system_error&) {
        closeHandle(client_);  // as the server's port itself would do
    }
}

void Relay::forward(int from, int to) {
    std::array<char, 65'536> buffer{};
    const auto count = ::recv(from, buffer.data(), buffer.size(), MSG_DONTWAIT);
    if (count < 0 && errno == EAGAIN) {
        return;
    }
    if (count <= 0 || !sendAll(to, buffer.data(), static_cast<std::size_t>(count))) {
        closeBoth();
        return;
    }
    if (from == client_) {
        sent_.insert(sent_.end(), buffer.begin(), buffer.begin() + count);
    }
}

Bytes sendAlone(std::uint16_t server_port, const Bytes& bytes) {
    int handle = connectTo(server_port);
    timeval patience{};
    patience.tv_sec = kPatienceS;
    orThrow(::setsockopt(handle, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience), "timeout");
    sendAll(handle, bytes.data(), bytes.size());
    ::shutdown(handle, SHUT_WR);
    Bytes answer;
    std::array<char, 4'096> buffer{};
    for (auto count = ::recv(handle, buffer.data(), buffer.size(), 0); count > 0;
         count = ::recv(handle, buffer.data(), buffer.size(), 0)) {
        answer.insert(answer.end(), buffer.begin(), buffer.begin() + count);
    }
    closeHandle(handle);
    return answer;
}

}  // namespace metier::system_tests
