#include "stream/stream_source.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "conversions.hpp"
#include "metier/motion/motion_run.hpp"

namespace metier::robot_skills {

using motion::StreamFollower;
using motion::StreamRefusal;

namespace {

// A stream slower than this stands, since every axis can stop from it within a few cycles; silence
// then is no loss [rad/s].
constexpr double kStanding = 0.02;
// Silence of a moving stream of no more than so many cycles is no loss.
constexpr int kLostAfterCycles = 6;
// Silence after which a standing stream is finished [s].
constexpr double kFinishedAfter = 0.5;
// The arm was sent the last set-point where it was sent a position this near to it [rad].
constexpr double kAtLast = 1e-5;
// Longest time until a stream must begin [s].
constexpr double kLongestWait = 10.0;
// Usual delay by the network [s]: the default of PlayOutDelay, and the time for which a stream
// without delay goes on at its last velocity; at least so many cycles.
constexpr double kLate = 0.02;
constexpr int kLateCycles = 3;

int cyclesIn(double time, double cycle) noexcept {
    constexpr double rounding = 1e-6;
    return static_cast<int>(std::ceil(time / cycle - rounding));
}

// A smaller step of the client's clock is rather a delay on the way [s].
constexpr double kClockStep = 0.05;
// Room for following a stream that was planned with the axes' full jerk.
constexpr double kJerkFactor = 4.0;

double fastestAxis(const StreamedPosition& from, const StreamedPosition& to) noexcept {
    const double time = (to.intended_time - from.intended_time).count();
    return time > 0.0 ? motion::maxDifference(from.position, to.position) / time : 0.0;
}

}  // namespace

motion::StreamOptions StreamSource::followerOptions(const Setup& setup) noexcept {
    const int late = std::max(kLateCycles, cyclesIn(kLate, setup.cycle));
    motion::StreamOptions options;
    options.cycle = motion::Seconds(setup.cycle);
    options.playout_delay_cycles =
        setup.play_out_delay ? cyclesIn(*setup.play_out_delay, setup.cycle) : late;
    options.extrapolated_cycles = late;
    options.standing_speed = kStanding;
    options.jerk_factor = kJerkFactor;
    options.braking_factor = motion::MotionRun::kHaltFactor;
    options.stale_cycles = std::numeric_limits<int>::max();  // silence is judged here
    return options;
}

Result<std::shared_ptr<StreamSource>> StreamSource::create(const motion::RobotModel& model,
                                                           const Setup& setup) {
    METIER_ASSIGN(auto follower,
                  StreamFollower::create(model, followerOptions(setup), setup.start));
    return std::make_shared<StreamSource>(model, setup, follower);
}

StreamSource::StreamSource(const motion::RobotModel& model, const Setup& setup,
                           const StreamFollower& follower)
    : model_(model),
      setup_(setup),
      play_out_cycles_(followerOptions(setup).playout_delay_cycles),
      follower_(follower),
      commanded_(toArray(setup.start)) {}

Result<void> StreamSource::checkFirst(const motion::JointVector& position) const {
    auto trial = follower_;
    if (const auto refused = trial.accept(position, {}, {})) {
        return fail(motion::toError(*refused));
    }
    return {};
}

void StreamSource::goOnFrom(const device::JointArray& from) {
    before_rest_ = results();
    auto follower = StreamFollower::create(model_, followerOptions(setup_), toVector(from));
    if (follower) {
        follower_ = *follower;
    }
    commanded_ = from;
    settling_.restart();
    end_ = End::none;
    cycles_ = 0;
    last_.reset();
    speed_ = 0.0;
    silence_ = 0.0;
    set_points_ = 0;
    missed_cycles_ = 0;
    dropped_ = 0;
}

device::SetPointSource::Next StreamSource::next(const device::ArmState& state,
                                                device::JointArray& set_point) noexcept {
    ++cycles_;
    if (takeRequest() != Request::none) {
        endBecause(End::asked);
    }
    takeSetPoints();
    watchSilence();
    const motion::Seconds now(static_cast<double>(cycles_) * setup_.cycle);
    commanded_ = toArray(follower_.next(now).position);
    set_point = commanded_;
    if (end_ == End::none || !follower_.atRest()) {
        return Next::set_point;
    }
    const auto status = settling_.take(state, commanded_, setup_.cycle);
    if (status == Settling::Status::off_target) {
        end_ = End::off_target;
    }
    return status == Settling::Status::waiting ? Next::set_point : Next::done;
}

void StreamSource::takeSetPoints() noexcept {
    silence_ += setup_.cycle;
    finishing_ = finish_asked_.load(std::memory_order_acquire);  // first: the queue then has all
    if (!last_) {
        dropAllButNewest();
    }
    while (const auto set_point = queue_.tryPop()) {
        if (end_ == End::none) {
            take(*set_point);
        }
    }
}

/// While the arm is made ready to follow, set-points wait. A stream that began with the oldest of
/// them would stay that late.
void StreamSource::dropAllButNewest() noexcept {
    for (auto waiting = queue_.size(); waiting > 1; --waiting) {
        static_cast<void>(queue_.tryPop());
    }
}

void StreamSource::take(const StreamedPosition& set_point) noexcept {
    const motion::Seconds now(static_cast<double>(cycles_) * setup_.cycle);
    if (isLate(set_point, now)) {
        endBecause(End::late);
        return;
    }
    const auto refused = follower_.accept(set_point.position, set_point.intended_time, now);
    if (refused && refused->reason == StreamRefusal::Reason::not_later) {
        ++dropped_;  // overtaken by a newer one on the way, or the sender's clock went back
        setup_.options.report->noteDropped();
        return;
    }
    if (refused) {
        refusal_ = refused;
        endBecause(End::refused);
        return;
    }
    speed_ = last_ ? fastestAxis(*last_, set_point) : 0.0;
    last_ = set_point;
    silence_ = 0.0;
    dropped_ = 0;
    ++set_points_;
    setup_.options.report->noteLag(
        std::max(0.0, follower_.lagOf(set_point.intended_time, now).count()));
    missed_cycles_ = follower_.missedCycles();
}

/// A set-point in advance waits for its time, and with it all that follow: the arm stays behind.
bool StreamSource::isLate(const StreamedPosition& set_point, motion::Seconds now) noexcept {
    follower_.skipRest(set_point.intended_time, now);
    const double lag = follower_.lagOf(set_point.intended_time, now).count();
    if (lag <= largestLag()) {
        return false;
    }
    setup_.options.report->noteLag(lag);
    return true;
}

/// No less than what a pause of the stream may cause.
double StreamSource::largestLag() const noexcept {
    return std::max(setup_.options.largest_lag, longestSilence());
}

double StreamSource::longestSilence() const noexcept {
    return std::max(setup_.options.longest_silence, kLostAfterCycles * setup_.cycle);
}

void StreamSource::watchSilence() noexcept {
    const bool silent = silence_ > longestSilence();
    if (end_ == End::none && silent && speed_ > kStanding) {
        endBecause(End::silent_moving);
        return;
    }
    if (last_ && silence_ > setup_.cycle && speed_ <= kStanding) {
        hold();
    }
    if (end_ == End::none && isFinished()) {
        end_ = dropped_ > 0 ? End::went_back : End::silent;
    }
}

bool StreamSource::isFinished() const noexcept {
    if (!last_) {
        return finishing_ || silence_ > kLongestWait;
    }
    if (speed_ > kStanding) {
        return false;
    }
    const bool at_last = finishing_ && follower_.atRest() &&
                         motion::maxDifference(toVector(commanded_), last_->position) < kAtLast;
    return at_last || silence_ > kFinishedAfter;
}

/// Repeats the last set-point of a standing stream, so that the arm gets there however far it is
/// behind. As late as can be without delaying what follows: a newer set-point may be on its way.
/// Without delay the follower holds it by itself.
void StreamSource::hold() noexcept {
    if (play_out_cycles_ == 0) {
        return;
    }
    const double delay = (play_out_cycles_ - 1) * setup_.cycle;
    const auto time = last_->intended_time + motion::Seconds(silence_ - delay);
    const motion::Seconds now(static_cast<double>(cycles_) * setup_.cycle);
    static_cast<void>(follower_.accept(last_->position, time, now));  // refused when it brakes
}

void StreamSource::endBecause(End end) noexcept {
    if (end_ == End::none || end_ == End::silent) {
        end_ = end;
        follower_.stop();
    }
}

PositionStreamResults StreamSource::results() const noexcept {
    auto results = before_rest_;
    results.set_points += set_points_;
    results.missed_cycles += missed_cycles_;
    results.duration += static_cast<double>(cycles_) * setup_.cycle;
    const auto figures = setup_.options.report->figures();
    results.largest_lag = figures.largest_lag;
    results.clock_step = figures.clock_step;
    results.refused_set_points = figures.refused;
    results.dropped_set_points = figures.dropped;
    return results;
}

std::string StreamSource::reported() const {
    const auto figures = setup_.options.report->figures();
    std::string text;
    if (std::abs(figures.clock_step) > kClockStep) {
        text +=
            fmt::format("; the client's clock went {} by {:.3f} s",
                        figures.clock_step > 0 ? "ahead" : "back", std::abs(figures.clock_step));
    }
    if (figures.dropped > 0) {
        text += fmt::format("; {} set-points were dropped for their times", figures.dropped);
    }
    if (figures.refused > 0) {
        text += fmt::format("; {} were refused, the last one: {}", figures.refused,
                            setup_.options.report->lastRefusal());
    }
    return text;
}

void StreamSource::tellDone(const skill::ExecutionHandle& tell) {
    const auto counted = results();
    tell.progress(counted.set_points);
    switch (end_) {
        case End::none:
        case End::asked:
            tell.atRest();
            return;
        case End::silent:
            tell.finish(positionStreamResultFields().write(counted));
            return;
        case End::silent_moving:
            tell.fail(skill::Reason::error,
                      fmt::format("the stream fell silent while it moved at {:.3f} rad/s: no "
                                  "set-point for {:.0f} ms after {} of them{}",
                                  speed_, 1e3 * longestSilence(), counted.set_points, reported()));
            return;
        case End::went_back:
            tell.fail(skill::Reason::error,
                      fmt::format("no set-point for {:.0f} ms whose time is after the last one's{}",
                                  1e3 * kFinishedAfter, reported()));
            return;
        case End::late:
            tell.fail(skill::Reason::limit_violated,
                      fmt::format("the arm would be {:.3f} s behind its client, limit {:.3f} s{}",
                                  setup_.options.report->figures().lag, largestLag(), reported()));
            return;
        case End::refused:
            tell.fail(skill::Reason::limit_violated, motion::toError(*refusal_).message);
            return;
        case End::off_target:
            settling_.tellOffTarget(tell);
            return;
    }
}

}  // namespace metier::robot_skills
