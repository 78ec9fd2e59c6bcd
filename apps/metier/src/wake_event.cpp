#include "wake_event.hpp"

#include <poll.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <stdexcept>

namespace metier::app {

WakeEvent::WakeEvent() : descriptor_(eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)) {
    if (descriptor_ < 0) {
        throw std::runtime_error(std::strerror(errno));
    }
}

WakeEvent::~WakeEvent() {
    close(descriptor_);
}

void WakeEvent::ring() noexcept {
    eventfd_write(descriptor_, 1);
}

void WakeEvent::wait(const StopSignal& signal) {
    std::array<pollfd, 2> requests{{{descriptor_, POLLIN, 0}, {signal.descriptor(), POLLIN, 0}}};
    while (poll(requests.data(), requests.size(), -1) < 0 && errno == EINTR) {
    }
    eventfd_t rung = 0;
    eventfd_read(descriptor_, &rung);
}

}  // namespace metier::app
