#include "metier/link/start_watch.hpp"

#include <chrono>
#include <cstdio>
#include <cstdlib>

namespace metier::link {

namespace {

constexpr std::chrono::milliseconds kOrderly{500};

}  // namespace

StartWatch::StartWatch(const StopSignal& signal) : thread_([this, &signal] { watch(signal); }) {}

StartWatch::~StartWatch() {
    over_.ring();
}

void StartWatch::watch(const StopSignal& signal) {
    if (over_.wait(signal) || over_.waitUntil(std::chrono::steady_clock::now() + kOrderly)) {
        return;
    }
    std::fputs("metier: stopped before it was ready\n", stderr);  // stderr may be closed: the
                                                                  // result is ignored
    std::_Exit(EXIT_FAILURE);
}

}  // namespace metier::link
