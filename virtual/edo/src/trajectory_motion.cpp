#include <algorithm>
#include <utility>

#include "trajectory_node.hpp"

namespace metier::virtual_edo {
namespace {

constexpr int kCyclesPerSecond = 100;
// Time for stopping a motion at full speed [s].
constexpr double kStopTime = 0.5;

}  // namespace

void TrajectoryNode::append(Segment segment, std::uint8_t delay) {
    double start = 0.0;
    if (running_.empty()) {
        time_ = 0.0;
        rate_ = 1.0;
    } else {
        // A fly move's successor begins when the fly move begins to slow down.
        start = std::max(time_, running_.back().start + running_.back().segment.brakingFrom());
    }
    running_.push_back({.segment = std::move(segment), .delay = delay, .start = start});
    next_asked_ = false;
    mode_ = AlgorithmMode::moving;
}

AxisValues TrajectoryNode::position() const {
    AxisValues values = running_.front().segment.at(time_ - running_.front().start);
    for (std::size_t i = 1; i < running_.size(); ++i) {
        if (time_ > running_[i].start) {
            const auto at = running_[i].segment.at(time_ - running_[i].start);
            for (std::size_t axis = 0; axis < kMostAxes; ++axis) {
                values[axis] += at[axis] - running_[i].segment.start()[axis];
            }
        }
    }
    return values;
}

void TrajectoryNode::advance() {
    if (running_.empty()) {
        mode_ = AlgorithmMode::finished;
        return;
    }
    const double change = kCycleSeconds / kStopTime;
    rate_ = std::clamp(rate_ + (stopping_ ? -change : change), 0.0, 1.0);
    time_ += rate_ * kCycleSeconds;
    const AxisValues next = position();
    for (std::size_t axis = 0; axis < kMostAxes; ++axis) {
        velocity_[axis] = (next[axis] - target_[axis]) / kCycleSeconds;
    }
    target_ = next;
    dropFinished();
    const bool last_flies = running_.size() == 1 && running_.front().delay == kFly;
    if (last_flies && !next_asked_ && !stopping_) {
        next_asked_ = true;
        say(FeedbackType::need_data, FeedbackData::next_wanted);
    }
    if (stopping_ && (rate_ <= 0.0 || running_.empty())) {
        onStopped();
    }
}

void TrajectoryNode::dropFinished() {
    while (!running_.empty() &&
           time_ >= running_.front().start + running_.front().segment.duration()) {
        const std::uint8_t delay = running_.front().delay;
        running_.pop_front();
        if (running_.empty()) {
            finishLast(delay);
        } else {
            say(FeedbackType::executed, FeedbackData::fly_ended);
        }
    }
}

void TrajectoryNode::finishLast(std::uint8_t delay) {
    if (!stopping_ && delay != 0 && delay != kFly) {
        mode_ = AlgorithmMode::waiting;
        wait_left_ = delay * kCyclesPerSecond;
        return;
    }
    jogging_ = false;
    mode_ = AlgorithmMode::finished;
    say(FeedbackType::executed,
        delay == kFly ? FeedbackData::last_fly_ended : FeedbackData::move_ended);
}

void TrajectoryNode::onStopped() {
    stopping_ = false;
    velocity_ = {};
    if (jogging_) {
        clearMotion();
        mode_ = AlgorithmMode::finished;
        say(FeedbackType::executed, FeedbackData::move_ended);
    } else if (mode_ == AlgorithmMode::moving || mode_ == AlgorithmMode::finished) {
        mode_ = AlgorithmMode::pause;
        say(FeedbackType::executed, FeedbackData::paused);
    }
}

}  // namespace metier::virtual_edo
