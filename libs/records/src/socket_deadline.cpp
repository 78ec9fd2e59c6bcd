#include "socket_deadline.hpp"

#include <sys/socket.h>

namespace metier::records {
namespace {

constexpr std::chrono::milliseconds kLook{500};

}  // namespace

SocketDeadline::SocketDeadline() : thread_([this](const std::stop_token& stop) { watch(stop); }) {}

SocketDeadline::Armed SocketDeadline::arm(int socket, std::chrono::milliseconds longest) {
    const std::lock_guard lock(mutex_);
    socket_ = socket;
    deadline_ = std::chrono::steady_clock::now() + longest;
    return Armed(*this);
}

void SocketDeadline::disarm() {
    const std::lock_guard lock(mutex_);
    deadline_.reset();
}

void SocketDeadline::watch(const std::stop_token& stop) {
    std::unique_lock lock(mutex_);
    while (!stop.stop_requested()) {
        nothing_.wait_for(lock, stop, kLook, [] { return false; });
        if (deadline_ && std::chrono::steady_clock::now() > *deadline_ && socket_ >= 0) {
            ::shutdown(socket_, SHUT_RDWR);
            deadline_.reset();
        }
    }
}

}  // namespace metier::records
