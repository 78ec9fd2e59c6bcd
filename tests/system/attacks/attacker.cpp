// A peer that attacks a server of the tests only: metier_attacker ATTACK HOST PORT SECONDS
// NAMESPACE STRANGER SKILL... . It ends after that time, or at a SIGTERM.
#include <fmt/format.h>
#include <sched.h>

#include <csignal>
#include <cstdlib>
#include <exception>

#include "attack.hpp"

int main(int argc, char** argv) {
    using namespace metier::system_tests;
    sigset_t end;
    sigemptyset(&end);
    sigaddset(&end, SIGTERM);
    pthread_sigmask(SIG_BLOCK, &end, nullptr);
    // Gives back an inherited real-time priority: that is for the attacked processes.
    const sched_param usual{};
    sched_setscheduler(0, SCHED_OTHER, &usual);
    try {
        const auto order = attackOrderFrom({argv + 1, argv + argc});
        const auto count = carryOut(order, [&end] {
            const timespec at_once{};
            return ::sigtimedwait(&end, nullptr, &at_once) == SIGTERM;
        });
        fmt::print("{} {} {} {} {}\n", kAttacked, count.connections, count.refused, count.cut,
                   count.requests);
        return EXIT_SUCCESS;
    } catch (const std::exception& error) {
        fmt::print(stderr, "attacker: {}\n", error.what());
        return EXIT_FAILURE;
    }
}
