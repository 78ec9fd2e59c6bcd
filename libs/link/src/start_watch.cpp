#include "metier/link/start_watch.hpp"

#include <chrono>
#include <cstdio>
#include <cstdlib>

namespace metier::link {

StartWatch::StartWatch(const StopSignal& signal, std::chrono::milliseconds orderly)
    : thread_([this, &signal, orderly] { watch(signal, orderly); }) {}

StartWatch::~StartWatch() {
    over_.ring();
}

void StartWatch::watch(const StopSignal& signal, std::chrono::milliseconds orderly) {
    if (over_.wait(signal) || over_.waitUntil(std::chrono::steady_clock::now() + orderly)) {
        return;
    }
    std::fputs("metier: stopped before it was ready\n", stderr);  // stderr may be closed: the
                                                                  // result is ignored
    std::_Exit(EXIT_FAILURE);
}

}  // namespace metier::link
