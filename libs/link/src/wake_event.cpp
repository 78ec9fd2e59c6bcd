#include "metier/link/wake_event.hpp"

#include <poll.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <stdexcept>

#include "poll_until.hpp"

namespace metier::link {

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

bool WakeEvent::wait(const StopSignal& signal) {
    std::array<pollfd, 2> requests{{{descriptor_, POLLIN, 0}, {signal.descriptor(), POLLIN, 0}}};
    while (poll(requests.data(), requests.size(), -1) < 0 && errno == EINTR) {
    }
    return take();
}

bool WakeEvent::waitUntil(SteadyTime deadline) {
    static_cast<void>(pollUntil(descriptor_, POLLIN, deadline, "a wake-up"));
    return take();
}

bool WakeEvent::take() noexcept {
    eventfd_t rung = 0;
    return eventfd_read(descriptor_, &rung) == 0;
}

}  // namespace metier::link
