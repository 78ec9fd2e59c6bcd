#include "tap.hpp"

#include <arpa/inet.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <utility>

namespace metier::benchmarks {
namespace {

using std::chrono::steady_clock;

constexpr int kWaitMs = 100;  // period of the check for a stop

sockaddr_in endpoint(const std::string& address, std::uint16_t port) {
    sockaddr_in there{};
    there.sin_family = AF_INET;
    there.sin_port = htons(port);
    inet_pton(AF_INET, address.c_str(), &there.sin_addr);
    return there;
}

const sockaddr* generic(const sockaddr_in& there) {
    return reinterpret_cast<const sockaddr*>(&there);  // NOLINT: as the interface asks
}

int listenAt(const std::string& address) {
    const int socket = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    const auto here = endpoint(address, 0);
    if (bind(socket, generic(here), sizeof here) != 0 || listen(socket, 4) != 0) {
        const std::string why = std::strerror(errno);
        close(socket);
        throw std::runtime_error("the tap cannot listen at " + address + ": " + why);
    }
    return socket;
}

std::uint16_t portOf(int socket) {
    sockaddr_in here{};
    socklen_t size = sizeof here;
    getsockname(socket, reinterpret_cast<sockaddr*>(&here), &size);  // NOLINT: as above
    return ntohs(here.sin_port);
}

void sendAtOnce(int socket) {
    const int on = 1;
    setsockopt(socket, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
}

/// Connects; -1 if no server listens there.
int dial(const std::string& address, std::uint16_t port) {
    const int socket = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    const auto there = endpoint(address, port);
    if (connect(socket, generic(there), sizeof there) != 0) {
        close(socket);
        return -1;
    }
    return socket;
}

bool sendAll(int socket, std::span<const std::byte> bytes) {
    while (!bytes.empty()) {
        const auto sent = send(socket, bytes.data(), bytes.size(), MSG_NOSIGNAL);
        if (sent <= 0) {
            return false;
        }
        bytes = bytes.subspan(static_cast<std::size_t>(sent));
    }
    return true;
}

}  // namespace

std::uint16_t freePort(const std::string& address) {
    const int socket = listenAt(address);
    const auto port = portOf(socket);
    close(socket);
    return port;
}

Tap::Tap(Options options)
    : options_(std::move(options)),
      listener_(listenAt(options_.address)),
      port_(portOf(listener_)),
      thread_([this](const std::stop_token& stop) { run(stop); }) {}

Tap::~Tap() {
    thread_.request_stop();
    thread_.join();
    close(listener_);
}

void Tap::run(const std::stop_token& stop) {
    while (!stop.stop_requested()) {
        pollfd waiting{listener_, POLLIN, 0};
        if (poll(&waiting, 1, kWaitMs) <= 0) {
            continue;
        }
        const int accepted = accept4(listener_, nullptr, nullptr, SOCK_CLOEXEC);
        const int dialled = dial(options_.address, options_.port);
        if (accepted >= 0 && dialled >= 0) {
            sendAtOnce(accepted);
            sendAtOnce(dialled);
            relay(accepted, dialled, stop);
        }
        close(accepted);
        close(dialled);
    }
}

void Tap::relay(int accepted, int dialled, const std::stop_token& stop) {
    const bool driver_dials = options_.dials == Dials::driver;
    const int driver = driver_dials ? accepted : dialled;
    const int controller = driver_dials ? dialled : accepted;
    const auto reader = options_.reader();
    std::array<pollfd, 2> ends{{{driver, POLLIN, 0}, {controller, POLLIN, 0}}};
    bool open = true;
    while (open && !stop.stop_requested()) {
        if (poll(ends.data(), ends.size(), kWaitMs) <= 0) {
            continue;
        }
        open = (ends[0].revents == 0 || pass(driver, controller, reader.get())) &&
               (ends[1].revents == 0 || pass(controller, driver, nullptr));
    }
}

bool Tap::pass(int from, int to, SetPointReader* reader) {
    std::array<std::byte, 65536> buffer;  // NOLINT(*-member-init): filled by recv()
    const auto got = recv(from, buffer.data(), buffer.size(), 0);
    const auto now = steady_clock::now();
    if (got <= 0) {
        return false;
    }
    const auto bytes = std::span(buffer).first(static_cast<std::size_t>(got));
    const bool sent = sendAll(to, bytes);
    if (reader != nullptr) {
        reader->read(bytes, [&](double position) { note(position, now); });
    }
    return sent;
}

void Tap::note(double position, steady_clock::time_point time) {
    const std::lock_guard lock(mutex_);
    seen_.push_back({time, position});
    last_ = time;
}

std::optional<steady_clock::time_point> Tap::last() const {
    const std::lock_guard lock(mutex_);
    return last_;
}

std::vector<Tap::SetPoint> Tap::take() {
    const std::lock_guard lock(mutex_);
    return std::exchange(seen_, {});
}

}  // namespace metier::benchmarks
