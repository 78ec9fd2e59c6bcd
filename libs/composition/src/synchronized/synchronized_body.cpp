#include "synchronized/synchronized_body.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "execution_id.hpp"
#include "synchronized/synchronized_fields.hpp"

namespace metier::composition {

using Stage = ArmLane::Stage;

namespace {

// What is left of the start delay when every arm must have said that it runs.
constexpr double kShareForDoubt = 0.25;
// The arms and their clocks are asked for this long at most.
constexpr std::chrono::seconds kLongestAnswer{10};

std::chrono::nanoseconds nanoseconds(std::chrono::duration<double> time) {
    return std::chrono::duration_cast<std::chrono::nanoseconds>(time);
}

bool arrived(const ArmLane& lane) {
    return lane.stage() == Stage::arrived;
}
bool standsStill(const ArmLane& lane) {
    return lane.stage() != Stage::runs;
}
bool isIdle(const ArmLane& lane) {
    return !lane.underWay();
}

}  // namespace

SynchronizedBody::SynchronizedBody(Setup setup)
    : options_(setup.options), least_duration_(setup.least_duration) {
    LaneOwner& owner = *this;
    for (auto& arm : setup.arms) {
        lanes_.push_back(std::make_unique<ArmLane>(std::move(arm), owner));
    }
}

bool SynchronizedBody::all(bool (*holds)(const ArmLane&)) const {
    return std::all_of(lanes_.begin(), lanes_.end(),
                       [holds](const auto& lane) { return holds(*lane); });
}

void SynchronizedBody::start(skill::Execution execution) {
    execution_ = std::move(execution);
    dropOld();
}

/// Before anything begins: what is Suspended is given up, what was Halted here is reset.
void SynchronizedBody::dropOld() {
    phase_ = Phase::dropping;
    timer_ = options_.executor->after(kRestTime, [this] { deadlinePassed(); });
    for (const auto& lane : lanes_) {
        if (phase_ == Phase::dropping && lane->needsReset()) {
            lane->drop();
        }
    }
    changed();
}

void SynchronizedBody::askAll(Ask ask, void (SynchronizedBody::*then)()) {
    phase_ = Phase::asking;
    const auto round = ++round_;
    timer_ = options_.executor->after(kLongestAnswer, [this] { deadlinePassed(); });
    pending_ = 0;
    for (const auto& lane : lanes_) {
        if (arrived(*lane)) {
            continue;
        }
        ++pending_;
        (*lane.*ask)([this, round, then](const Answer& failure) {
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

void SynchronizedBody::begin() {
    phase_ = Phase::moving;
    double duration = least_duration_;
    for (const auto& lane : lanes_) {
        duration = arrived(*lane) ? duration : std::max(duration, lane->shortestDuration());
    }
    double stop_time = 0.0;
    for (const auto& lane : lanes_) {
        stop_time = arrived(*lane) ? stop_time : std::max(stop_time, lane->stopTime(duration));
    }
    const auto time = options_.clock.utcNow() + std::chrono::duration_cast<UtcTime::duration>(
                                                    nanoseconds(options_.start_delay));
    begun_lanes_.clear();
    for (const auto& lane : lanes_) {
        if (!arrived(*lane)) {
            begun_lanes_.push_back(lane.get());
            const auto id = composition::childExecutionId(
                {options_.origin, execution_.id(), lane->name(), ++begun_});
            const auto& move = lane->move();
            execution_.started({id, move.description().name, move.serverUrl()});
            lane->begin({id, execution_.id(), duration, stop_time, time});
        }
    }
    timer_ = options_.executor->after(nanoseconds((1.0 - kShareForDoubt) * options_.start_delay),
                                      [this] { checkBegun(); });
}

/// Before the moment has come: an arm that did not hear of it would be left behind.
void SynchronizedBody::checkBegun() {
    const auto late = std::find_if(lanes_.begin(), lanes_.end(), [](const auto& lane) {
        return lane->stage() == Stage::runs && !lane->begun();
    });
    if (phase_ == Phase::moving && late != lanes_.end()) {
        failed({skill::Reason::error, fmt::format("{} did not begin in time; start delay {} s",
                                                  (*late)->name(), options_.start_delay.count())});
    }
}

void SynchronizedBody::changed() {
    if (phase_ == Phase::stopping) {
        if (all(isIdle)) {
            stopped();
        }
    } else if ((phase_ == Phase::moving || phase_ == Phase::resting) && all(arrived)) {
        finish();
    } else if (phase_ == Phase::resting && !rest_told_ && all(standsStill)) {
        rest_told_ = true;
        timer_.cancel();
        execution_.atRest();
    } else if (phase_ == Phase::dropping && all(isIdle)) {
        askArms();
    }
}

void SynchronizedBody::failed(LaneFailure failure) {
    if (phase_ == Phase::stopping || phase_ == Phase::over) {
        return;
    }
    failure_ = std::move(failure);
    stop();
}

/// All brake at once; the whole follows them to Suspended.
void SynchronizedBody::suspendedByOther(const std::string& why) {
    if (phase_ == Phase::moving) {
        suspendLanes();
        execution_.suspend(why);
    }
}

void SynchronizedBody::suspendLanes() {
    for (const auto& lane : lanes_) {
        lane->suspend();
    }
}

void SynchronizedBody::stop() {
    phase_ = Phase::stopping;
    timer_ = options_.executor->after(kRestTime, [this] { deadlinePassed(); });
    for (const auto& lane : lanes_) {
        lane->halt();
    }
    if (all(isIdle)) {
        stopped();
    }
}

void SynchronizedBody::stopped() {
    phase_ = Phase::over;
    timer_.cancel();
    if (failure_) {
        execution_.fail(failure_->reason, failure_->text);
    } else {
        execution_.atRest();
    }
}

/// Something did not answer, or did not come to rest.
void SynchronizedBody::deadlinePassed() {
    std::string names;
    for (const auto& lane : lanes_) {
        const bool waited_for = phase_ == Phase::asking    ? !arrived(*lane)
                                : phase_ == Phase::resting ? lane->stage() == Stage::runs
                                                           : lane->underWay();
        if (waited_for) {
            names += (names.empty() ? "" : ", ") + lane->name();
        }
    }
    if (phase_ == Phase::stopping) {
        const auto text =
            fmt::format("{} did not come to rest within {} s after Halt", names, kRestTime.count());
        failure_ =
            LaneFailure{skill::Reason::error, failure_ ? failure_->text + "; " + text : text};
        stopped();
        return;
    }
    failed({skill::Reason::error, fmt::format("not all answered in time: {}", names)});
}

Result<void> SynchronizedBody::suspend() {
    const bool moves = phase_ == Phase::moving;
    phase_ = Phase::resting;
    rest_told_ = false;
    ++round_;
    timer_ = options_.executor->after(kRestTime, [this] { deadlinePassed(); });
    if (moves) {
        suspendLanes();
    }
    changed();
    return {};
}

Result<void> SynchronizedBody::resume() {
    dropOld();
    return {};
}

void SynchronizedBody::halt() {
    if (phase_ == Phase::over) {
        execution_.atRest();
    } else if (phase_ != Phase::stopping) {
        stop();
    }
}

void SynchronizedBody::forceStop() noexcept {
    for (const auto& lane : lanes_) {
        lane->halt();
    }
}

/// Those that have moved together; an arm that was where it should be, or arrived before a Resume
/// of the others, has no times to compare.
std::vector<const ArmLane*> SynchronizedBody::measured() const {
    auto lanes = begun_lanes_;
    std::erase_if(lanes, [](const ArmLane* lane) { return !lane->hasWay(); });
    return lanes;
}

void SynchronizedBody::finish() {
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
Spread spreadOf(const std::vector<const ArmLane*>& lanes, Value value) {
    const auto [first, last] =
        std::minmax_element(lanes.begin(), lanes.end(),
                            [&](const auto* a, const auto* b) { return value(*a) < value(*b); });
    return {value(**first), value(**last)};
}

/// The sum of the two largest.
template <typename Value>
double twoLargest(const std::vector<const ArmLane*>& lanes, Value value) {
    double largest = 0.0;
    double second = 0.0;
    for (const auto* lane : lanes) {
        const double now = value(*lane);
        second = std::max(second, std::min(now, largest));
        largest = std::max(largest, now);
    }
    return largest + second;
}

}  // namespace

Results resultsOf(const std::vector<const ArmLane*>& lanes) {
    Results results;
    if (lanes.empty()) {
        return results;
    }
    const auto start = spreadOf(lanes, [](const ArmLane& lane) { return lane.startTime(); });
    const auto end = spreadOf(lanes, [](const ArmLane& lane) { return lane.endTime(); });
    results.skew_at_start = start.last - start.first;
    results.skew_at_end = end.last - end.first;
    results.largest_skew =
        std::max({results.skew_at_start, results.skew_at_end,
                  twoLargest(lanes, [](const ArmLane& lane) { return lane.lateness(); })});
    results.clock_uncertainty = twoLargest(lanes, [](const ArmLane& lane) {
        return std::chrono::duration<double>(lane.clockOffset().uncertainty).count();
    });
    results.duration = end.last - start.first;
    return results;
}

}  // namespace metier::composition
