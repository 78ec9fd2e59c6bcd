#pragma once

#include <optional>

#include "metier/base/clock.hpp"
#include "metier/base/error.hpp"

namespace metier::robot_skills {

/// A UtcTime as parameters and results have it [s since 1970-01-01 UTC].
double toSeconds(UtcTime time) noexcept;

/// Whether a motion could begin then.
/// Errors: out_of_range if `start_time` is over, or further ahead than a minute.
Result<void> checkStartTime(const std::optional<double>& start_time, const Clock& clock);

/// Planned and actual times of the set-points of one motion.
///
/// Threading: made by the owner's thread; then used by one thread: the cycle thread, or the owner's
/// while the arm does not have the motion. Nothing allocates, locks or throws.
class Timetable {
public:
    /// A start that is missed by more is not made up for [s].
    static constexpr double kLatestStart = 0.1;

    /// \param clock      must outlive this
    /// \param start_time by the clock [s since 1970-01-01 UTC]; none: with the first cycle
    Timetable(const Clock& clock, const std::optional<double>& start_time);

    enum class Due {
        not_yet,
        now,
        missed,  ///< the first cycle came more than kLatestStart after the start
    };
    /// Once per cycle, before its set-point is made.
    Due look() noexcept;
    /// By how much the motion has to go on now; no more than `cycle`, so that the arm makes no
    /// leap [s].
    double step(double cycle) noexcept;

    /// The motion goes on after a rest, with the next cycle.
    void restart() noexcept;

    double firstTime() const noexcept { return utc(first_); }  ///< [s since 1970-01-01 UTC]
    double lastTime() const noexcept { return utc(last_); }    ///< as firstTime()
    double largestLateness() const noexcept { return largest_lateness_; }  ///< [s]
    double missedBy() const noexcept { return missed_by_; }                ///< [s]

private:
    double utc(SteadyTime time) const noexcept;

    const Clock& clock_;
    SteadyTime steady_;  ///< the same moment as utc_
    double utc_;
    std::optional<SteadyTime> start_;
    std::optional<SteadyTime> zero_;  ///< when the motion had done nothing, had it been in time
    bool begun_ = false;
    SteadyTime first_{};
    SteadyTime now_{};
    SteadyTime last_{};
    double done_ = 0.0;  ///< since zero_ [s]
    double largest_lateness_ = 0.0;
    double missed_by_ = 0.0;
};

}  // namespace metier::robot_skills
