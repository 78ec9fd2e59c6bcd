#include "trajectory_node.hpp"

#include <algorithm>
#include <utility>

namespace metier::virtual_edo {
namespace {

// In cycles of 10 ms.
constexpr int kUnwatchedAfterReset = 1100;
constexpr std::size_t kMostMoves = 1000;

}  // namespace

TrajectoryNode::TrajectoryNode(const Software& software, const motion::RobotModel& model,
                               Answer answer)
    : software_(software), planner_(model), answer_(std::move(answer)) {}

std::size_t TrajectoryNode::load(std::size_t axes) {
    if (axes_ == 0 && (axes == kArmAxes || axes == kMostAxes)) {
        axes_ = axes;
    }
    return axes_;
}

bool TrajectoryNode::isBusy() const {
    return mode_ == AlgorithmMode::moving || mode_ == AlgorithmMode::waiting || !running_.empty() ||
           !moves_.empty() || !commands_.empty();
}

void TrajectoryNode::onJointState(const BusReport& report) {
    if (axes_ == 0 || report.joints.size() != axes_) {
        return;
    }
    bool alarm = false;
    for (const auto& joint : report.joints) {
        alarm =
            alarm || joint.has(JointFlag::power_stage_open) || joint.has(JointFlag::overcurrent);
    }
    calibrated_ = !report.joints[kArmAxes - 1].has(JointFlag::uncalibrated);
    for (std::size_t axis = 0; axis < axes_; ++axis) {
        measured_[axis] = report.joints[axis].position;
    }
    if (mode_ == AlgorithmMode::uninitialised) {
        holdMeasured();
        mode_ = AlgorithmMode::initialised;
    }
    if (isSwitchedOff()) {
        return;
    }
    if (alarm && !alarm_) {
        dropAll(FeedbackData::move_ended);
    }
    alarm_ = alarm;
    if (alarm_) {
        holdMeasured();
    }
}

void TrajectoryNode::rebase(const BusReport& report) {
    onJointState(report);
    if (running_.empty() && !isSwitchedOff()) {
        holdMeasured();
    }
}

void TrajectoryNode::holdMeasured() {
    target_ = measured_;
    velocity_ = {};
}

void TrajectoryNode::clearMotion() {
    running_.clear();
    time_ = 0.0;
    rate_ = 1.0;
    stopping_ = false;
    jogging_ = false;
    next_asked_ = false;
    wait_left_ = 0;
}

void TrajectoryNode::dropAll(FeedbackData data) {
    const std::size_t dropped = jogging_ ? 0 : running_.size();
    const std::size_t waiting = moves_.size();
    const bool was_active = mode_ != AlgorithmMode::initialised;
    clearMotion();
    moves_.clear();
    commands_.clear();
    jogs_.clear();
    if (was_active) {
        mode_ = AlgorithmMode::finished;
    }
    for (std::size_t i = 0; i < dropped + waiting; ++i) {
        say(FeedbackType::executed, data);
    }
}

void TrajectoryNode::onBraked() {
    if (software_.external_control && isSwitchedOff()) {
        mode_ = AlgorithmMode::finished;
        holdMeasured();
    }
}

void TrajectoryNode::onReset() {
    unwatched_left_ = kUnwatchedAfterReset;
}

bool TrajectoryNode::watchesCollisions() const {
    const bool control_taken = software_.external_control && isSwitchedOff();
    return calibrated_ && mode_ != AlgorithmMode::uninitialised && unwatched_left_ == 0 &&
           !control_taken;
}

std::uint8_t TrajectoryNode::switchControl(std::uint8_t mode) {
    constexpr std::uint8_t kDone = 0;
    constexpr std::uint8_t kRefused = 1;
    if (!software_.external_control) {
        if (mode == 1 && !isSwitchedOff()) {
            takeControl(AlgorithmMode::switched_off);
            return kDone;
        }
        if (mode == 2 && isSwitchedOff()) {
            giveControlBack();
            return kDone;
        }
        return kRefused;
    }
    const auto wanted =
        static_cast<AlgorithmMode>(static_cast<int>(AlgorithmMode::switched_off) + mode - 1);
    if (mode == 0 && isSwitchedOff()) {
        giveControlBack();
    } else if (mode == 1 && !isSwitchedOff()) {
        takeControl(AlgorithmMode::switched_off);
    } else if (mode >= 2 && mode <= 4 && mode_ != wanted) {
        takeControl(wanted);
    } else {
        return kRefused;
    }
    return kDone;
}

void TrajectoryNode::takeControl(AlgorithmMode mode) {
    // A moving arm stops where it is.
    dropAll(FeedbackData::dropped_by_control);
    holdMeasured();
    mode_ = mode;
}

void TrajectoryNode::giveControlBack() {
    // Older software waits for the next joint state.
    takeControl(software_.external_control ? AlgorithmMode::initialised
                                           : AlgorithmMode::uninitialised);
}

void TrajectoryNode::externalControl(const AxisValues& position, const AxisValues& velocity) {
    if (!isSwitchedOff() || !software_.external_control) {
        return;
    }
    velocity_ = velocity;
    if (mode_ != AlgorithmMode::velocity_control && mode_ != AlgorithmMode::voltage_control) {
        target_ = position;
    }
}

void TrajectoryNode::move(const Movement& movement) {
    if (mode_ == AlgorithmMode::uninitialised) {
        say(FeedbackType::error, FeedbackData::uninitialised);
    } else if (movement.command != move_command::kMove) {
        commands_.push_back(movement);
    } else if (moves_.size() < kMostMoves) {
        moves_.push_back(movement);
    }
}

void TrajectoryNode::jog(const Movement& movement) {
    if (mode_ == AlgorithmMode::uninitialised) {
        say(FeedbackType::error, FeedbackData::uninitialised);
    } else {
        jogs_.push_back(movement);
    }
}

void TrajectoryNode::step() {
    unwatched_left_ = std::max(0, unwatched_left_ - 1);
    if (isSwitchedOff()) {
        if (mode_ == AlgorithmMode::velocity_control) {
            for (std::size_t axis = 0; axis < kMostAxes; ++axis) {
                target_[axis] += velocity_[axis] * kCycleSeconds;
            }
        }
        return;
    }
    takeCommands();
    takeJogs();
    switch (mode_) {
        case AlgorithmMode::moving:
            advance();
            break;
        case AlgorithmMode::waiting:
            if (--wait_left_ <= 0) {
                mode_ = AlgorithmMode::finished;
                say(FeedbackType::executed, FeedbackData::delay_over);
            }
            break;
        case AlgorithmMode::blocked:
        case AlgorithmMode::finished:
            mode_ = AlgorithmMode::initialised;
            break;
        default:
            velocity_ = {};
            break;
    }
}

void TrajectoryNode::takeCommands() {
    while (!commands_.empty()) {
        const auto command = commands_.front().command;
        commands_.pop_front();
        switch (command) {
            case move_command::kPause:
                pauseMove();
                break;
            case move_command::kResume:
                resumeMove();
                break;
            case move_command::kCancel:
                cancelMove();
                break;
            default:
                say(FeedbackType::error, FeedbackData::undefined_command);
                break;
        }
    }
    while (!moves_.empty() && takeMove()) {
    }
}

bool TrajectoryNode::takeMove() {
    if (alarm_) {
        moves_.pop_front();
        say(FeedbackType::executed, FeedbackData::move_ended);
        return true;
    }
    const bool may_start = mode_ == AlgorithmMode::initialised || mode_ == AlgorithmMode::moving;
    if (!may_start || stopping_ || jogging_ ||
        (!running_.empty() && running_.back().delay != kFly)) {
        return false;
    }
    const Movement movement = std::move(moves_.front());
    moves_.pop_front();
    const AxisValues start = running_.empty() ? target_ : running_.back().segment.end();
    auto segment = planner_.planMove(start, axes_, movement);
    if (!segment) {
        fail(FeedbackData::no_motion);
        fail(FeedbackData::move_failed);
        return true;
    }
    append(std::move(*segment), movement.delay);
    return true;
}

void TrajectoryNode::fail(FeedbackData data) {
    if (running_.empty()) {
        mode_ = AlgorithmMode::blocked;
    }
    say(FeedbackType::error, data);
}

void TrajectoryNode::pauseMove() {
    if (alarm_) {
        say(FeedbackType::executed, FeedbackData::none);
    } else if (mode_ == AlgorithmMode::moving) {
        stopping_ = true;
    } else {
        if (mode_ == AlgorithmMode::waiting) {
            say(FeedbackType::executed, FeedbackData::delay_over);
        }
        mode_ = AlgorithmMode::pause;
        say(FeedbackType::executed, FeedbackData::paused);
    }
}

void TrajectoryNode::resumeMove() {
    if (alarm_) {
        say(FeedbackType::executed, FeedbackData::resume_in_alarm);
        return;
    }
    stopping_ = false;
    if (mode_ == AlgorithmMode::pause) {
        mode_ = running_.empty() ? AlgorithmMode::finished : AlgorithmMode::moving;
    }
    say(FeedbackType::executed, FeedbackData::resumed);
}

void TrajectoryNode::cancelMove() {
    velocity_ = {};
    dropAll(FeedbackData::dropped_by_cancel);
    mode_ = AlgorithmMode::finished;
    say(FeedbackType::executed, FeedbackData::cancelled);
}

void TrajectoryNode::takeJogs() {
    while (!jogs_.empty()) {
        const Movement movement = std::move(jogs_.front());
        jogs_.pop_front();
        if (movement.command == move_command::kJogStop) {
            stopping_ = stopping_ || (jogging_ && mode_ == AlgorithmMode::moving);
        } else if (!alarm_ && running_.empty()) {
            startJog(movement);
        }
    }
}

void TrajectoryNode::startJog(const Movement& movement) {
    auto segment = planner_.planJog(target_, axes_, movement);
    if (!segment) {
        fail(FeedbackData::no_motion);
        return;
    }
    append(std::move(*segment), 0);
    jogging_ = true;
    if (movement.type == move_type::kLinear) {
        say(FeedbackType::executed, FeedbackData::linear_jog_started);
    }
}

}  // namespace metier::virtual_edo
