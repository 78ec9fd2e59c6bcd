#include "metier/link/restart_pause.hpp"

#include <algorithm>
#include <utility>

namespace metier::link {

std::chrono::milliseconds RestartPause::next(std::chrono::nanoseconds ran_for) noexcept {
    if (ran_for >= kProven) {
        next_ = kShortest;
    }
    return std::exchange(next_, std::min(2 * next_, kLongest));
}

}  // namespace metier::link
