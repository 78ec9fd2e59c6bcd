#include "metier/link/back_off.hpp"

#include <algorithm>
#include <condition_variable>
#include <mutex>

namespace metier::link {

void BackOff::wait(const std::stop_token& stop) {
    std::mutex mutex;
    std::condition_variable_any never;
    std::unique_lock lock(mutex);
    never.wait_for(lock, stop, pause_, [] { return false; });
    pause_ = std::min(2 * pause_, kLongest);
}

}  // namespace metier::link
