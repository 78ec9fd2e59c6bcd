#include "metier/motion/execution.hpp"

#include <algorithm>

namespace metier::motion {

namespace {
constexpr double kHaltFactor = 2.0;
}  // namespace

MotionExecution::MotionExecution(Trajectory trajectory, const LateCyclePolicy& late) noexcept
    : trajectory_(std::move(trajectory)),
      late_(late),
      profile_(trajectory_.profile()),
      current_(trajectory_.sampleAt(clock_)) {}

bool MotionExecution::tooLate(Seconds step) const noexcept {
    return late_.cycle.count() > 0 && step > (late_.most_skipped + 1.5) * late_.cycle;
}

SetPoint MotionExecution::next(Seconds step) noexcept {
    if (tooLate(step) && !atRest()) {
        stopped_late_ = stopped_late_ || mode_ == Mode::running;
        stop();
        step = late_.cycle;
    }
    profile_time_ += std::max(step.count(), 0.0);
    clock_ = profile_.at(profile_time_);
    current_ = trajectory_.sampleAt(clock_);
    return current_;
}

void MotionExecution::replan(double limit_factor) noexcept {
    ScalarLimits limits = trajectory_.clockLimits();
    limits.acceleration *= limit_factor;
    limits.jerk *= limit_factor;
    if (mode_ == Mode::stopping || override_ <= 0) {
        profile_ = Profile::brake(clock_, limits);
    } else {
        limits.velocity *= override_;
        profile_ = Profile::toRest(clock_, trajectory_.clockEnd(), limits);
    }
    profile_time_ = 0;
}

void MotionExecution::stop() noexcept {
    if (mode_ == Mode::running) {
        mode_ = Mode::stopping;
        replan(1.0);
    }
}

void MotionExecution::halt() noexcept {
    mode_ = Mode::stopping;
    replan(kHaltFactor);
}

void MotionExecution::resume() noexcept {
    if (mode_ == Mode::stopping) {
        mode_ = Mode::running;
        stopped_late_ = false;
        replan(1.0);
    }
}

void MotionExecution::setOverride(double factor) noexcept {
    override_ = std::clamp(factor, 0.0, 1.0);
    if (mode_ == Mode::running && !finished()) {
        replan(1.0);
    }
}

bool MotionExecution::atRest() const noexcept {
    return profile_time_ >= profile_.duration();
}

bool MotionExecution::finished() const noexcept {
    return atRest() && clock_.position >= trajectory_.clockEnd();
}

double MotionExecution::pathParameter() const noexcept {
    return trajectory_.pathParameter(clock_).position;
}

Seconds MotionExecution::remaining() const noexcept {
    return Seconds(std::max(profile_.duration() - profile_time_, 0.0));
}

}  // namespace metier::motion
