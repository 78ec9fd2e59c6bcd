#include "arm.hpp"

#include <cmath>
#include <utility>

namespace metier::virtual_iiwa {

namespace {

using motion::JointVector;

// A servo motion ends so long after it reached its goal [s].
constexpr double kServoPatience = 300.0;
// An axis may be so much faster than its limit, for a cycle's rounding.
constexpr double kSpeedReserve = 1.05;

}  // namespace

Arm::Arm(const motion::RobotModel& model, const JointVector& position)
    : model_(&model), position_(position) {
    history_.fill(position);
}

// ---- commands ----------------------------------------------------------------------------------

void Arm::move(Plan plan) {
    brake(End::cancelled);
    never_begun_.reset();
    next_ = [this, planned = std::move(plan)] { return begin(planned); };
}

void Arm::servoTo(const JointVector& target, const MotionLimits& limits) {
    if (joint_servo_ != nullptr && !braking_) {
        joint_servo_->follow(target);
        return;
    }
    brake(End::cancelled);
    never_begun_.reset();
    next_ = [this, target, limits] {
        auto servo =
            std::make_unique<JointServo>(*model_, position_, JointVector(position_.size()), limits);
        servo->follow(target);
        joint_servo_ = servo.get();
        servo_ = std::move(servo);
        return true;
    };
}

void Arm::servoTo(const MovingFrame& frame, const motion::Pose& base_from_tool,
                  const MotionLimits& limits) {
    if (linear_servo_ != nullptr && !braking_) {
        linear_servo_->follow(base_from_tool);
        return;
    }
    brake(End::cancelled);
    never_begun_.reset();
    next_ = [this, frame, base_from_tool, limits] {
        auto servo = std::make_unique<LinearServo>(frame, position_, limits);
        servo->follow(base_from_tool);
        linear_servo_ = servo.get();
        servo_ = std::move(servo);
        return true;
    };
}

void Arm::brake(End end) {
    if (std::exchange(next_, nullptr) && !path_ && !servo_) {
        never_begun_ = end;
    }
    brake_end_ = end;
    if (braking_) {
        return;
    }
    if (path_) {
        path_->profile =
            motion::Profile::brake(path_->profile.at(path_->time), path_->path->limits);
        path_->time = 0.0;
        braking_ = true;
    }
    if (servo_) {
        servo_->brake();
        braking_ = true;
    }
}

void Arm::halt() {
    clear();
    next_ = nullptr;
    never_begun_.reset();
}

void Arm::clear() {
    path_.reset();
    servo_.reset();
    joint_servo_ = nullptr;
    linear_servo_ = nullptr;
    braking_ = false;
}

// ---- one cycle ---------------------------------------------------------------------------------

std::optional<Arm::End> Arm::step() {
    Moved ended = std::exchange(never_begun_, std::nullopt);
    if (path_) {
        ended = stepPath();
    } else if (servo_) {
        ended = stepServo();
    } else if (next_ && !std::exchange(next_, nullptr)()) {
        ended = End::failed;
    }
    newest_ = (newest_ + 1) % kHistory;
    history_[newest_] = position_;
    return ended;
}

bool Arm::begin(const Plan& plan) {
    auto planned = plan(position_);
    if (!planned) {
        return false;
    }
    const auto profile = motion::Profile::toRest({}, 1.0, (*planned)->limits);
    path_ = Run{std::move(*planned), profile};
    return true;
}

Arm::Moved Arm::stepPath() {
    path_->time += kCycleSeconds;
    if (!follow(path_->path->at(path_->profile.at(path_->time).position, position_))) {
        return std::nullopt;
    }
    if (path_->time >= path_->profile.duration()) {
        return finish(braking_ ? brake_end_ : End::done);
    }
    return std::nullopt;
}

Arm::Moved Arm::stepServo() {
    if (!follow(servo_->step(kCycleSeconds, position_))) {
        return std::nullopt;
    }
    if (braking_ && servo_->standing() >= 0.0) {
        return finish(brake_end_);
    }
    if (servo_->standing() > kServoPatience) {
        return finish(End::done);
    }
    return std::nullopt;
}

/// Goes there, if it can be done in one cycle; else the motion breaks down.
bool Arm::follow(const std::optional<JointVector>& wanted) {
    bool possible = wanted.has_value();
    for (std::size_t axis = 0; possible && axis < position_.size(); ++axis) {
        const double most = kSpeedReserve * model_->limits(axis).velocity * kCycleSeconds;
        possible = std::abs((*wanted)[axis] - position_[axis]) <= most;
    }
    if (possible) {
        position_ = *wanted;
    } else {
        breakDown();
    }
    return possible;
}

/// Every axis brakes by itself, off the path; the motion fails.
void Arm::breakDown() {
    const auto& before = history_[(newest_ + kHistory - 1) % kHistory];
    JointVector velocity(position_.size());
    for (std::size_t axis = 0; axis < velocity.size(); ++axis) {
        velocity[axis] = (position_[axis] - before[axis]) / kCycleSeconds;
    }
    clear();
    servo_ = std::make_unique<JointServo>(*model_, position_, velocity, MotionLimits{});
    brake(End::failed);
}

Arm::Moved Arm::finish(End end) {
    clear();
    // A caller that has given the next motion knows that this one was cancelled.
    return next_ && end == End::cancelled ? std::nullopt : std::optional(end);
}

JointVector Arm::velocity() const noexcept {
    const auto& oldest = history_[(newest_ + 1) % kHistory];
    JointVector velocity = position_;
    for (std::size_t axis = 0; axis < velocity.size(); ++axis) {
        velocity[axis] = (position_[axis] - oldest[axis]) / ((kHistory - 1) * kCycleSeconds);
    }
    return velocity;
}

}  // namespace metier::virtual_iiwa
