#include "metier/motion/motion_run.hpp"

#include <algorithm>

namespace metier::motion {

MotionRun::MotionRun(Trajectory trajectory, const LateCyclePolicy& late) noexcept
    : trajectory_(std::move(trajectory)),
      late_(late),
      profile_(trajectory_.profile()),
      current_(trajectory_.sampleAt(state_)) {}

bool MotionRun::tooLate(Seconds step) const noexcept {
    return late_.cycle.count() > 0 && step > (late_.most_skipped + 1.5) * late_.cycle;
}

SetPoint MotionRun::next(Seconds step) noexcept {
    if (tooLate(step) && !atRest()) {
        stopped_late_ = stopped_late_ || mode_ == Mode::running;
        stop();
        step = late_.cycle;
    }
    brakeHarder();
    const double passed = std::max(step.count(), 0.0);
    profile_time_ += pace_ ? pace_->advance(passed) : passed;
    state_ = profile_.at(profile_time_);
    if (pace_) {
        state_ = pace_->slowed(state_);
    }
    current_ =
        along_ == Along::clock ? trajectory_.sampleAt(state_) : trajectory_.sampleOnPath(state_);
    return current_;
}

ScalarState MotionRun::onPath() const noexcept {
    return along_ == Along::path ? state_ : trajectory_.pathParameter(state_);
}

ScalarState MotionRun::onClock() const noexcept {
    return along_ == Along::clock ? state_ : trajectory_.clockAt(state_);
}

/// The slower it gets the less of the limits goes into the bends of the path: the more is left.
void MotionRun::brakeHarder() noexcept {
    constexpr double worthwhile = 0.97;  // part of its time with which a stop is planned anew
    const bool lets_go = profile_.jerkAt(profile_time_) > 0;
    if (mode_ != Mode::stopping || brake_factor_ == 0 || atRest() || lets_go) {
        return;
    }
    const ScalarState now = onPath();
    const Profile harder = trajectory_.brake(now, brake_factor_);
    if (harder.end() <= 1.0 && harder.jerkAt(0) <= 0 &&
        harder.duration() < worthwhile * (profile_.duration() - profile_time_)) {
        follow(harder, Along::path, now);
    }
}

void MotionRun::follow(const Profile& profile, Along along, const ScalarState& now) noexcept {
    profile_ = profile;
    along_ = along;
    state_ = now;
    profile_time_ = 0;
    pace_.reset();
}

/// Stops with `factor` of the robot's own limits; by the plan's where the path is too short.
void MotionRun::brake(double factor) noexcept {
    brake_factor_ = factor;
    const ScalarState now = onPath();
    const Profile own = trajectory_.brake(now, factor);
    if (own.end() <= 1.0) {
        follow(own, Along::path, now);
    } else {
        follow(trajectory_.brakeClock(onClock(), factor), Along::clock, onClock());
    }
}

/// Runs to the end of the path, from any state.
void MotionRun::goOn() noexcept {
    const ScalarState now = onClock();
    if (override_ <= 0) {
        follow(trajectory_.brakeClock(onClock(), 1.0), Along::clock, now);
        return;
    }
    follow(trajectory_.runClock(now, override_), Along::clock, now);
}

void MotionRun::stop() noexcept {
    if (mode_ != Mode::running) {
        return;
    }
    mode_ = Mode::stopping;
    const Profile gentle = trajectory_.brakeClock(onClock(), 1.0);
    if (gentle.duration() > kGentleStop.count()) {
        brake(1.0);
    } else {
        brake_factor_ = 0;
        follow(gentle, Along::clock, state_);
    }
}

void MotionRun::stopIn(Seconds length) noexcept {
    if (mode_ == Mode::running) {
        mode_ = Mode::stopping;
        brake_factor_ = 0;
        pace_.emplace(length.count());
    }
}

void MotionRun::halt() noexcept {
    mode_ = Mode::stopping;
    if (!atRest()) {
        brake(kHaltFactor);
    }
}

void MotionRun::resume() noexcept {
    if (mode_ == Mode::stopping) {
        mode_ = Mode::running;
        stopped_late_ = false;
        goOn();
    }
}

void MotionRun::setOverride(double factor) noexcept {
    override_ = std::clamp(factor, 0.0, 1.0);
    if (mode_ == Mode::running && !finished()) {
        goOn();
    }
}

bool MotionRun::atRest() const noexcept {
    return profile_time_ >= profile_.duration() || (pace_ && pace_->over());
}

bool MotionRun::finished() const noexcept {
    const double end = along_ == Along::clock ? trajectory_.clockEnd() : 1.0;
    return atRest() && state_.position >= end;
}

double MotionRun::pathParameter() const noexcept {
    return onPath().position;
}

Seconds MotionRun::remaining() const noexcept {
    const double left = std::max(profile_.duration() - profile_time_, 0.0);
    return Seconds(pace_ ? std::min(pace_->remaining(), left) : left);
}

StoppingEstimate MotionRun::stoppingEstimate() const noexcept {
    if (atRest()) {
        return {};
    }
    const ScalarState now = onPath();
    const Profile halt = trajectory_.brake(now, kHaltFactor);
    const Seconds time = std::min(Seconds(halt.duration()), remaining());
    const SetPoint end = trajectory_.sampleOnPath({std::min(halt.end(), 1.0), 0.0, 0.0});
    return {time, distanceBetween(trajectory_.toolPose(current_.position),
                                  trajectory_.toolPose(end.position))};
}

}  // namespace metier::motion
