#include "arm_drive.hpp"

#include <algorithm>
#include <cmath>

namespace metier::edo_driver {

using device::EndCause;
using device::SafetyState;

namespace {

using namespace std::chrono_literals;

constexpr double kStandstillSpeed = 0.01;  // [rad/s]
constexpr int kRestCycles = 5;
// After this time a robot with closed brakes stands still, even if it reports velocities.
constexpr auto kLongestBraking = 2s;

}  // namespace

ArmDrive::ArmDrive(const EdoOptions& options, device::ArmCore& core, SafetyKeeper& safety)
    : options_(options),
      core_(core),
      safety_(safety),
      command_(options.axes),
      watch_(options.following) {
    state_.position = device::JointArray(options.layout.axes);
    state_.velocity = state_.position;
    state_.commanded_position = state_.position;
}

void ArmDrive::connected(const Generation& generation) noexcept {
    handover_.begin(generation);
    state_.cycle = 0;
    state_.missed_cycles = 0;
    last_cycle_ = {};
}

void ArmDrive::disconnected() noexcept {
    leftover_ = leftover_ || !free();
    handover_.begin(handover_.generation());
    core_.publish(state_);
    core_.end(EndCause::disconnected);
}

void ArmDrive::onJointStates(const JointStates& states, SteadyTime now, Wire& wire) {
    measure(states, now);
    tick(now);
    if (handover_.state() == Handover::State::free) {
        whileFree(now, wire);
    } else if (handover_.state() == Handover::State::taken) {
        whileTaken(now, wire);
    }
    state_.commanded_position = command_.position();
    core_.publish(state_);
    reportProblems();
    endWhenDue(now);
}

void ArmDrive::onResponse(const ServiceResponse& response, SteadyTime now) {
    handover_.onResponse(response, now);
    tick(now);
}

void ArmDrive::onAlgorithmState(const AlgorithmState& state, SteadyTime now) noexcept {
    handover_.onAlgorithmState(state, now);
}

void ArmDrive::tick(SteadyTime now) {
    if (auto ticked = handover_.tick(now); !ticked) {
        safety_.fault(ticked.error().message);
    }
    if (safety_.jointsSilent() && core_.active() != nullptr) {
        core_.publish(state_);
        core_.end(EndCause::disconnected);
    }
}

void ArmDrive::giveBackLeftover(SteadyTime now, Wire& wire) {
    leftover_ = false;
    handover_.giveBack(now, wire);
}

JointSetPoint ArmDrive::holding() const noexcept {
    JointSetPoint joints;
    joints.count = options_.layout.count();
    std::copy(command_.position().begin(), command_.position().end(), joints.position.begin());
    if (options_.layout.gripper) {
        joints.position[options_.layout.axes] = free() ? measured_gripper_ : gripper_;
    }
    return joints;
}

// ---- one cycle ---------------------------------------------------------------------------------

void ArmDrive::measure(const JointStates& states, SteadyTime now) noexcept {
    const auto axes = options_.layout.axes;
    state_.standstill = true;
    for (std::size_t axis = 0; axis < axes; ++axis) {
        const auto& joint = states.joints[axis];
        state_.position[axis] = joint.position;
        state_.velocity[axis] = std::isfinite(joint.velocity) ? joint.velocity : 0.0;
        state_.standstill = state_.standstill && std::abs(state_.velocity[axis]) < kStandstillSpeed;
    }
    if (options_.layout.gripper) {
        measured_gripper_ = states.joints[axes].position;
    }
    ++state_.cycle;
    if (last_cycle_ != SteadyTime{} && now - last_cycle_ > 2 * EdoOptions::kCycle) {
        ++state_.missed_cycles;
    }
    last_cycle_ = now;
    state_.stamp = now;
}

void ArmDrive::whileFree(SteadyTime now, Wire& wire) {
    command_.settle(state_.position);
    watch_.reset();
    cycles_at_rest_ = 0;
    gripper_ = measured_gripper_;
    if (!normal()) {
        return;
    }
    if (leftover_) {
        giveBackLeftover(now, wire);
    } else if (core_.active() != nullptr && !core_.stopRequested()) {
        handover_.take(now, wire);
    }
}

void ArmDrive::whileTaken(SteadyTime now, Wire& wire) {
    if (!safety_.robotAllowsMotion()) {
        command_.reset(state_.position);  // the brakes hold the joints, nothing else does
        watch_.reset();
        giveBackWhenDue(now, wire);
        return;
    }
    if (!pacer_.due(now)) {
        return;
    }
    move(core_.active());
    wire.send(text_.write(handover_.generation(), options_.layout, holding()));
    judgeFollowing(now);
    giveBackWhenDue(now, wire);
}

void ArmDrive::move(device::SetPointSource* source) noexcept {
    if (!normal() || core_.stopRequested()) {
        command_.brake();
    } else if (source != nullptr) {
        follow(*source);
    } else {
        command_.hold();
    }
}

void ArmDrive::follow(device::SetPointSource& source) noexcept {
    state_.commanded_position = command_.position();
    state_.safety = SafetyState::normal;
    auto set_point = command_.position();
    if (source.next(state_, set_point) == device::SetPointSource::Next::done) {
        command_.hold();
        end(EndCause::done);
        return;
    }
    if (const auto violation = command_.accept(set_point)) {
        violation_ = violation;
        command_.brake();
    }
}

void ArmDrive::judgeFollowing(SteadyTime now) noexcept {
    if (const auto lag = watch_.check(command_.position(), state_.position, now)) {
        lag_ = lag;
        command_.reset(state_.position);
        watch_.reset();
    }
}

void ArmDrive::reportProblems() {
    if (violation_) {
        safety_.fault(toText(*violation_), SafetyKeeper::Limit::violated);
        violation_.reset();
    }
    if (lag_) {
        safety_.fault(fmt::format(
            "axis {} does not follow: {:.3f} rad from its set-point for {} ms (limit {:.3f} rad)",
            lag_->axis + 1, lag_->distance,
            std::chrono::duration<double, std::milli>(options_.following.time).count(),
            options_.following.distance));
        lag_.reset();
    }
}

bool ArmDrive::atRest() const noexcept {
    return cycles_at_rest_ >= kRestCycles;
}

void ArmDrive::endWhenDue(SteadyTime now) noexcept {
    const bool stands = state_.standstill && command_.standing();
    cycles_at_rest_ = stands ? cycles_at_rest_ + 1 : 0;
    if (core_.active() == nullptr) {
        return;
    }
    const bool safe = normal();
    if (safe && !core_.stopRequested()) {
        stopping_since_.reset();
        return;
    }
    stopping_since_ = stopping_since_.value_or(now);
    const bool never_moved = free() && stands;
    if (!atRest() && !never_moved && now - *stopping_since_ <= kLongestBraking) {
        return;
    }
    end(safe ? EndCause::stopped : EndCause::safety);
}

void ArmDrive::end(EndCause cause) noexcept {
    state_.commanded_position = command_.position();
    core_.publish(state_);
    core_.end(cause);
    stopping_since_.reset();
    cycles_at_rest_ = 0;
}

void ArmDrive::giveBackWhenDue(SteadyTime now, Wire& wire) {
    const auto rest = EdoOptions::kCycle * cycles_at_rest_;
    const bool wanted = wanted_ == Wanted::for_sources && normal();
    if (core_.active() == nullptr && atRest() && (!wanted || rest >= options_.hold_control)) {
        handover_.giveBack(now, wire);
    }
}

}  // namespace metier::edo_driver
