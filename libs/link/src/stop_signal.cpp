#include "metier/link/stop_signal.hpp"

#include <poll.h>
#include <sys/signalfd.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <limits>
#include <stdexcept>

namespace metier::link {

StopSignal::StopSignal() {
    sigset_t signals;
    sigemptyset(&signals);
    sigaddset(&signals, SIGINT);
    sigaddset(&signals, SIGTERM);
    sigaddset(&signals, SIGHUP);
    pthread_sigmask(SIG_BLOCK, &signals, nullptr);
    descriptor_ = signalfd(-1, &signals, SFD_CLOEXEC);
    if (descriptor_ < 0) {
        throw std::runtime_error(std::strerror(errno));
    }
}

StopSignal::~StopSignal() {
    close(descriptor_);
}

void StopSignal::endWithin(std::chrono::seconds longest) noexcept {
    alarm(static_cast<unsigned>(longest.count()));
}

void StopSignal::outliveOutput() noexcept {
    std::signal(SIGPIPE, SIG_IGN);
}

bool StopSignal::waitUntil(SteadyTime deadline) const {
    for (;;) {
        const auto left = std::chrono::ceil<std::chrono::milliseconds>(
            deadline - std::chrono::steady_clock::now());
        constexpr std::int64_t kLongest = std::numeric_limits<int>::max();
        pollfd request{descriptor_, POLLIN, 0};
        const int ready = poll(
            &request, 1, static_cast<int>(std::clamp<std::int64_t>(left.count(), 0, kLongest)));
        if (ready > 0) {
            return true;
        }
        if (ready == 0 && left.count() < kLongest) {
            return false;
        }
        if (ready < 0 && errno != EINTR) {
            return false;
        }
    }
}

}  // namespace metier::link
