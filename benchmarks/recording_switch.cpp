#include "recording_switch.hpp"

#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <utility>

namespace metier::benchmarks {

RecordingSwitch::RecordingSwitch(std::string file) : file_(std::move(file)) {
    std::array<int, 2> ends{};
    if (socketpair(AF_UNIX, SOCK_STREAM, 0, ends.data()) != 0) {
        throw std::runtime_error(std::strerror(errno));
    }
    client_side_ = ends[0];
    server_side_ = ends[1];
}

RecordingSwitch::~RecordingSwitch() {
    close(client_side_);
    close(server_side_);
}

void RecordingSwitch::turn(bool on) const {
    const char wanted = on ? 1 : 0;
    char answer = 0;
    if (write(client_side_, &wanted, 1) != 1 || read(client_side_, &answer, 1) != 1) {
        throw std::runtime_error("the server does not turn recording on or off");
    }
}

RecordingSwitch::Serving::Serving(int socket, Switch turn)
    : socket_(socket), thread_([socket, turn = std::move(turn)] {
          char wanted = 0;
          while (read(socket, &wanted, 1) == 1) {
              turn(wanted != 0, [socket] {
                  const char answer = 1;
                  static_cast<void>(write(socket, &answer, 1));
              });
          }
      }) {}

RecordingSwitch::Serving::~Serving() {
    if (socket_ >= 0) {
        shutdown(socket_, SHUT_RD);  // the thread reads no more
    }
}

RecordingSwitch::Serving::Serving(Serving&& other) noexcept
    : socket_(std::exchange(other.socket_, -1)), thread_(std::move(other.thread_)) {}

RecordingSwitch::Serving& RecordingSwitch::Serving::operator=(Serving&& other) noexcept {
    std::swap(socket_, other.socket_);
    std::swap(thread_, other.thread_);
    return *this;
}

}  // namespace metier::benchmarks
