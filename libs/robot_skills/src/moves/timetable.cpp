#include "moves/timetable.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace metier::robot_skills {

namespace {

// A time further ahead is rather a mistake of the clock [s].
constexpr double kFurthestStart = 60.0;

double secondsBetween(SteadyTime from, SteadyTime to) noexcept {
    return std::chrono::duration<double>(to - from).count();
}

SteadyTime later(SteadyTime time, double seconds) noexcept {
    return time +
           std::chrono::duration_cast<SteadyTime::duration>(std::chrono::duration<double>(seconds));
}

}  // namespace

double toSeconds(UtcTime time) noexcept {
    return std::chrono::duration<double>(time.time_since_epoch()).count();
}

Result<void> checkStartTime(const std::optional<double>& start_time, const Clock& clock) {
    if (!start_time) {
        return {};
    }
    const double ahead = *start_time - toSeconds(clock.utcNow());
    if (ahead < 0.0) {
        return fail(Errc::out_of_range,
                    fmt::format("StartTime is {:.3f} s ago by the clock of this server", -ahead));
    }
    if (ahead > kFurthestStart) {
        return fail(Errc::out_of_range, fmt::format("StartTime is {:.3f} s ahead by the clock of "
                                                    "this server, limit {} s",
                                                    ahead, kFurthestStart));
    }
    return {};
}

Timetable::Timetable(const Clock& clock, const std::optional<double>& start_time)
    : clock_(clock), steady_(clock.now()), utc_(toSeconds(clock.utcNow())) {
    if (start_time) {
        start_ = later(steady_, *start_time - utc_);
    }
}

Timetable::Due Timetable::look() noexcept {
    now_ = clock_.now();
    if (zero_ || !start_) {
        return Due::now;
    }
    const double late = secondsBetween(*start_, now_);
    if (late <= 0.0) {
        return Due::not_yet;
    }
    missed_by_ = late;
    return late > kLatestStart ? Due::missed : Due::now;
}

double Timetable::step(double cycle) noexcept {
    double step = cycle;
    if (!zero_) {
        zero_ = start_.value_or(later(now_, -cycle));
        step = std::min(cycle, secondsBetween(*zero_, now_));
    }
    if (!begun_) {
        begun_ = true;
        first_ = now_;
    }
    last_ = now_;
    done_ += step;
    const double lateness = secondsBetween(*zero_, now_) - done_;
    largest_lateness_ = std::max(largest_lateness_, std::abs(lateness));
    return step;
}

void Timetable::restart() noexcept {
    start_.reset();
    zero_.reset();
    done_ = 0.0;
}

double Timetable::utc(SteadyTime time) const noexcept {
    return begun_ ? utc_ + secondsBetween(steady_, time) : 0.0;
}

}  // namespace metier::robot_skills
