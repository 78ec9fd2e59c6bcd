#include "connection.hpp"

#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "metier/base/text.hpp"

namespace metier::http {
namespace {

using std::chrono::milliseconds;

/// \param end getpeername or getsockname
void addressOf(int socket, decltype(&getpeername) end, std::string& ip, int& port) {
    sockaddr_storage storage{};
    socklen_t length = sizeof storage;
    auto* const address = reinterpret_cast<sockaddr*>(&storage);  // NOLINT: POSIX's way
    std::array<char, NI_MAXHOST> host{};
    std::array<char, NI_MAXSERV> service{};
    if (end(socket, address, &length) == 0 &&
        getnameinfo(address, length, host.data(), host.size(), service.data(), service.size(),
                    NI_NUMERICHOST | NI_NUMERICSERV) == 0) {
        ip = host.data();
        port = numberIn<int>(service.data()).value_or(0);
    }
}

}  // namespace

Connection::Connection(int socket, const HttpLimits& limits) : socket_(socket), limits_(limits) {
    // A peer that is cut off acknowledges nothing: the system then ends the connection.
    const auto unacknowledged = static_cast<unsigned int>(limits.send_time.count());
    setsockopt(socket, IPPROTO_TCP, TCP_USER_TIMEOUT, &unacknowledged, sizeof unacknowledged);
}

short Connection::waitFor(short events, milliseconds longest) const {
    const auto deadline = std::chrono::steady_clock::now() + longest;
    for (;;) {
        const auto left =
            std::chrono::ceil<milliseconds>(deadline - std::chrono::steady_clock::now());
        pollfd waiting{socket_, events, 0};
        const int ready =
            poll(&waiting, 1, static_cast<int>(std::max(left, milliseconds(0)).count()));
        if (ready >= 0 || errno != EINTR) {
            return ready > 0 ? waiting.revents : short{0};
        }
    }
}

bool Connection::awaitRequest() {
    return begin_ < end_ || (waitFor(POLLIN, limits_.idle_time) & POLLIN) != 0;
}

void Connection::beginRequest() {
    budget_ = limits_.head_bytes;
    rest_.reset();
    deadline_ = std::chrono::steady_clock::now() + limits_.request_time;
}

void Connection::beginBody(std::optional<std::size_t> length) {
    budget_ = limits_.body_bytes;
    rest_ = length;
}

bool Connection::endRequest() {
    std::array<char, 1024> skipped{};
    while (rest_.value_or(0) > 0) {
        read(skipped.data(), std::min(skipped.size(), *rest_));
    }
    return rest_.has_value();
}

bool Connection::is_readable() const {
    return begin_ < end_ || (waitFor(POLLIN, milliseconds(0)) & POLLIN) != 0;
}

bool Connection::is_writable() const {
    const auto events = waitFor(POLLOUT | POLLRDHUP, limits_.send_time);
    return (events & POLLOUT) != 0 && (events & (POLLRDHUP | POLLHUP | POLLERR)) == 0;
}

bool Connection::fill() {
    const auto left = std::chrono::ceil<milliseconds>(deadline_ - std::chrono::steady_clock::now());
    if (left.count() <= 0 || waitFor(POLLIN, left) == 0) {
        return false;
    }
    const auto count = recv(socket_, buffer_.data(), buffer_.size(), 0);
    begin_ = 0;
    end_ = count > 0 ? static_cast<std::size_t>(count) : 0;
    return count > 0;
}

ssize_t Connection::read(char* bytes, size_t size) {
    if (budget_ == 0 || (begin_ == end_ && !fill())) {
        rest_.reset();  // what comes next is no beginning of a request
        return -1;
    }
    const auto count = std::min({size, end_ - begin_, budget_});
    std::memcpy(bytes, buffer_.data() + begin_, count);
    begin_ += count;
    budget_ -= count;
    if (rest_) {
        *rest_ -= std::min(*rest_, count);
    }
    return static_cast<ssize_t>(count);
}

ssize_t Connection::write(const char* bytes, size_t size) {
    for (;;) {
        if ((waitFor(POLLOUT, limits_.send_time) & POLLOUT) == 0) {
            return -1;
        }
        const auto count = send(socket_, bytes, size, MSG_NOSIGNAL | MSG_DONTWAIT);
        if (count >= 0 || (errno != EAGAIN && errno != EWOULDBLOCK && errno != EINTR)) {
            return count;
        }
    }
}

void Connection::get_remote_ip_and_port(std::string& ip, int& port) const {
    addressOf(socket_, &getpeername, ip, port);
}

void Connection::get_local_ip_and_port(std::string& ip, int& port) const {
    addressOf(socket_, &getsockname, ip, port);
}

}  // namespace metier::http
