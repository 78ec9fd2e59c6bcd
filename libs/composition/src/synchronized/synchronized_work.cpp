#include "synchronized/synchronized_work.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "execution_id.hpp"

namespace metier::composition {

using Stage = ArmMove::Stage;

namespace {

// Share of the start delay that remains when every arm must have reported Running.
constexpr double kShareForDoubt = 0.25;
// The arms and their clocks are asked for this long at most.
constexpr std::chrono::seconds kLongestAnswer{10};

std::chrono::nanoseconds nanoseconds(std::chrono::duration<double> time) {
    return std::chrono::duration_cast<std::chrono::nanoseconds>(time);
}

bool arrived(const ArmMove& arm_move) {
    return arm_move.stage() == Stage::arrived;
}
bool standsStill(const ArmMove& arm_move) {
    return arm_move.stage() != Stage::runs;
}
bool isIdle(const ArmMove& arm_move) {
    return !arm_move.underWay();
}

}  // namespace

SynchronizedWork::SynchronizedWork(Setup setup)
    : options_(setup.options), least_duration_(setup.least_duration) {
    ArmMoveOwner& owner = *this;
    for (auto& arm : setup.arms) {
        arm_moves_.push_back(std::make_unique<ArmMove>(std::move(arm), owner));
    }
}

bool SynchronizedWork::all(bool (*holds)(const ArmMove&)) const {
    return std::all_of(arm_moves_.begin(), arm_moves_.end(),
                       [holds](const auto& arm_move) { return holds(*arm_move); });
}

void SynchronizedWork::start(skill::ExecutionHandle execution) {
    execution_ = std::move(execution);
    dropOld();
}

/// Before anything begins: what is Suspended is given up, what was Halted here is reset.
void SynchronizedWork::dropOld() {
    phase_ = Phase::dropping;
    timer_ = options_.executor->after(kRestTime, [this] { deadlinePassed(); });
    for (const auto& arm_move : arm_moves_) {
        if (phase_ == Phase::dropping && arm_move->needsReset()) {
            arm_move->drop();
        }
    }
    changed();
}

void SynchronizedWork::askAll(Ask ask, void (SynchronizedWork::*then)()) {
    phase_ = Phase::asking;
    const auto round = ++round_;
    timer_ = options_.executor->after(kLongestAnswer, [this] { deadlinePassed(); });
    pending_ = 0;
    for (const auto& arm_move : arm_moves_) {
        if (arrived(*arm_move)) {
            continue;
        }
        ++pending_;
        (*arm_move.*ask)([this, round, then](const Answer& failure) {
            if (round != round_ || phase_ != Phase::asking) {
                return;
            }
            if (failure) {
                failed(*failure);
            } else if (--pending_ == 0) {
                (this->*then)();
            }
        });
    }
}

void SynchronizedWork::begin() {
    phase_ = Phase::moving;
    double duration = least_duration_;
    for (const auto& arm_move : arm_moves_) {
        duration = arrived(*arm_move) ? duration : std::max(duration, arm_move->shortestDuration());
    }
    double stop_time = 0.0;
    for (const auto& arm_move : arm_moves_) {
        stop_time =
            arrived(*arm_move) ? stop_time : std::max(stop_time, arm_move->stopTime(duration));
    }
    const auto time = options_.clock.utcNow() + std::chrono::duration_cast<UtcTime::duration>(
                                                    nanoseconds(options_.start_delay));
    begun_arms_.clear();
    for (const auto& arm_move : arm_moves_) {
        if (!arrived(*arm_move)) {
            begun_arms_.push_back(arm_move.get());
            const auto id = composition::stepExecutionId(
                {options_.origin, execution_.id(), arm_move->name(), ++begun_});
            const auto& move = arm_move->move();
            execution_.started({id, move.description().name, move.serverUrl()});
            arm_move->begin({id, execution_.id(), duration, stop_time, time});
        }
    }
    timer_ = options_.executor->after(nanoseconds((1.0 - kShareForDoubt) * options_.start_delay),
                                      [this] { checkBegun(); });
}

/// Halts the whole if an arm does not run yet shortly before the begin: it would be left behind.
void SynchronizedWork::checkBegun() {
    const auto late = std::find_if(arm_moves_.begin(), arm_moves_.end(), [](const auto& arm_move) {
        return arm_move->stage() == Stage::runs && !arm_move->begun();
    });
    if (phase_ == Phase::moving && late != arm_moves_.end()) {
        failed({skill::Reason::error, fmt::format("{} did not begin in time; start delay {} s",
                                                  (*late)->name(), options_.start_delay.count())});
    }
}

void SynchronizedWork::changed() {
    if (phase_ == Phase::stopping) {
        if (all(isIdle)) {
            stopped();
        }
    } else if ((phase_ == Phase::moving || phase_ == Phase::resting) && all(arrived)) {
        finish();
    } else if (phase_ == Phase::resting && !rest_reported_ && all(standsStill)) {
        rest_reported_ = true;
        timer_.cancel();
        execution_.atRest();
    } else if (phase_ == Phase::dropping && all(isIdle)) {
        askArms();
    }
}

void SynchronizedWork::failed(ArmFailure failure) {
    if (phase_ == Phase::stopping || phase_ == Phase::over) {
        return;
    }
    failure_ = std::move(failure);
    stop();
}

/// All brake at once; the whole follows them to Suspended.
void SynchronizedWork::suspendedByOther(const std::string& why) {
    if (phase_ == Phase::moving) {
        suspendArms();
        execution_.suspend(why);
    }
}

void SynchronizedWork::suspendArms() {
    for (const auto& arm_move : arm_moves_) {
        arm_move->suspend();
    }
}

void SynchronizedWork::stop() {
    phase_ = Phase::stopping;
    timer_ = options_.executor->after(kRestTime, [this] { deadlinePassed(); });
    for (const auto& arm_move : arm_moves_) {
        arm_move->halt();
    }
    if (all(isIdle)) {
        stopped();
    }
}

void SynchronizedWork::stopped() {
    phase_ = Phase::over;
    timer_.cancel();
    if (failure_) {
        execution_.fail(failure_->reason, failure_->text);
    } else {
        execution_.atRest();
    }
}

/// Something did not answer, or did not come to rest.
void SynchronizedWork::deadlinePassed() {
    std::string names;
    for (const auto& arm_move : arm_moves_) {
        const bool waited_for = phase_ == Phase::asking    ? !arrived(*arm_move)
                                : phase_ == Phase::resting ? arm_move->stage() == Stage::runs
                                                           : arm_move->underWay();
        if (waited_for) {
            names += (names.empty() ? "" : ", ") + arm_move->name();
        }
    }
    if (phase_ == Phase::stopping) {
        const auto text =
            fmt::format("{} did not come to rest within {} s after Halt", names, kRestTime.count());
        failure_ = ArmFailure{skill::Reason::error, failure_ ? failure_->text + "; " + text : text};
        stopped();
        return;
    }
    failed({skill::Reason::error, fmt::format("not all answered in time: {}", names)});
}

Result<void> SynchronizedWork::suspend() {
    const bool moves = phase_ == Phase::moving;
    phase_ = Phase::resting;
    rest_reported_ = false;
    ++round_;
    timer_ = options_.executor->after(kRestTime, [this] { deadlinePassed(); });
    if (moves) {
        suspendArms();
    }
    changed();
    return {};
}

Result<void> SynchronizedWork::resume() {
    dropOld();
    return {};
}

void SynchronizedWork::halt() {
    if (phase_ == Phase::over) {
        execution_.atRest();
    } else if (phase_ != Phase::stopping) {
        stop();
    }
}

void SynchronizedWork::forceStop() noexcept {
    for (const auto& arm_move : arm_moves_) {
        arm_move->halt();
    }
}

/// Arms that have moved together. An arm that was at its target already, or arrived before a Resume
/// of the others, has no times to compare.
std::vector<const ArmMove*> SynchronizedWork::measured() const {
    auto arm_moves = begun_arms_;
    std::erase_if(arm_moves, [](const ArmMove* arm_move) { return !arm_move->hasPath(); });
    return arm_moves;
}

void SynchronizedWork::finish() {
    phase_ = Phase::over;
    timer_.cancel();
    execution_.finish(resultFields().write(resultsOf(measured())));
}

namespace {

struct Spread {
    double first = 0.0;
    double last = 0.0;
};

template <typename Value>
Spread spreadOf(const std::vector<const ArmMove*>& arm_moves, Value value) {
    const auto [first, last] =
        std::minmax_element(arm_moves.begin(), arm_moves.end(),
                            [&](const auto* a, const auto* b) { return value(*a) < value(*b); });
    return {value(**first), value(**last)};
}

/// The sum of the two largest.
template <typename Value>
double twoLargest(const std::vector<const ArmMove*>& arm_moves, Value value) {
    double largest = 0.0;
    double second = 0.0;
    for (const auto* arm_move : arm_moves) {
        const double now = value(*arm_move);
        second = std::max(second, std::min(now, largest));
        largest = std::max(largest, now);
    }
    return largest + second;
}

}  // namespace

Results resultsOf(const std::vector<const ArmMove*>& arm_moves) {
    Results results;
    if (arm_moves.empty()) {
        return results;
    }
    const auto start =
        spreadOf(arm_moves, [](const ArmMove& arm_move) { return arm_move.startTime(); });
    const auto end =
        spreadOf(arm_moves, [](const ArmMove& arm_move) { return arm_move.endTime(); });
    results.skew_at_start = start.last - start.first;
    results.skew_at_end = end.last - end.first;
    results.largest_skew = std::max(
        {results.skew_at_start, results.skew_at_end,
         twoLargest(arm_moves, [](const ArmMove& arm_move) { return arm_move.lateness(); })});
    results.clock_uncertainty = twoLargest(arm_moves, [](const ArmMove& arm_move) {
        return std::chrono::duration<double>(arm_move.clockOffset().uncertainty).count();
    });
    results.duration = end.last - start.first;
    return results;
}

}  // namespace metier::composition
