#pragma once

#include <algorithm>
#include <chrono>
#include <utility>

namespace metier::link {

/// Pauses before a program that ended by itself is started again: 0.5 s first, doubled at each
/// further end, up to 30 s. After a run of kProven or longer the pause is 0.5 s again.
///
/// Threading: one thread.
///
///     RestartPause pause;
///     wait(pause.next(ran_for));  // 0.5 s, then 1 s, 2 s, ... 30 s while it keeps ending early
class RestartPause {
public:
    /// Length of the first pause.
    static constexpr std::chrono::milliseconds kShortest{500};
    /// Length from which pauses do not grow any more.
    static constexpr std::chrono::milliseconds kLongest{30'000};
    /// Length of a run after which the program counts as working.
    static constexpr std::chrono::seconds kProven{60};

    /// \param ran_for time from the program's start to its end
    /// \return time to wait before the next start
    std::chrono::milliseconds next(std::chrono::nanoseconds ran_for) noexcept {
        next_ = ran_for >= kProven ? kShortest : next_;
        return std::exchange(next_, std::min(2 * next_, kLongest));
    }

private:
    std::chrono::milliseconds next_ = kShortest;
};

}  // namespace metier::link
