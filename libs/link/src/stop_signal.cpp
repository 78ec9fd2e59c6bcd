#include "metier/link/stop_signal.hpp"

#include <poll.h>
#include <sys/signalfd.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstring>
#include <stdexcept>

#include "poll_until.hpp"

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
    return pollUntil(descriptor_, POLLIN, deadline, "a signal").has_value();
}

}  // namespace metier::link
