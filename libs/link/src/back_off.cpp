#include "metier/link/back_off.hpp"

#include <algorithm>
#include <condition_variable>
#include <mutex>

namespace metier::link {

void waitFor(const std::stop_token& stop, std::chrono::nanoseconds time) {
    std::mutex mutex;
    std::condition_variable_any never;
    std::unique_lock lock(mutex);
    never.wait_for(lock, stop, time, [] { return false; });
}

void BackOff::wait(const std::stop_token& stop) {
    waitFor(stop, pause_);
    pause_ = std::min(2 * pause_, kLongest);
}

}  // namespace metier::link
