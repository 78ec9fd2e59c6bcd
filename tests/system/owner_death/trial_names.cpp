#include <fmt/format.h>

#include "trial.hpp"

namespace metier::system_tests {

std::string_view toString(Fault fault) {
    switch (fault) {
        case Fault::killed:
            return "kill -9";
        case Fault::stopped:
            return "SIGSTOP";
        case Fault::link_down:
            return "link down";
        case Fault::dropped:
            return "packets dropped";
        case Fault::one_way:
            return "dropped one way";
        case Fault::half_open:
            return "half-open connection";
        case Fault::closed:
            return "session closed";
        case Fault::silent:
            return "no more heartbeats";
        case Fault::stale:
            return "stale commander wakes";
    }
    return "?";
}

std::string_view toString(AtFault state) {
    constexpr std::array kNames{"Ready", "Running", "Suspended", "Suspending", "Halting"};
    return kNames.at(static_cast<std::size_t>(state));
}

bool needsCable(Fault fault) {
    return fault == Fault::link_down || fault == Fault::dropped || fault == Fault::one_way ||
           fault == Fault::half_open;
}

std::string toString(const Trial& trial) {
    return fmt::format("{} while {} at {}/{}, {}, lease {} ms", toString(trial.fault),
                       toString(trial.at), trial.point, kPoints, toString(trial.policy),
                       trial.lease.count());
}

}  // namespace metier::system_tests
