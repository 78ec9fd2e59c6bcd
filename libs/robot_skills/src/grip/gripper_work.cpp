#include "grip/gripper_work.hpp"

#include <utility>

namespace metier::robot_skills {

using device::SafetyState;
using skill::Reason;

GripperWork::GripperWork(device::Gripper& gripper, Ask ask, Judge judge, Moving moving)
    : gripper_(gripper), ask_(std::move(ask)), telling_(std::make_shared<Telling>()) {
    telling_->judge = std::move(judge);
    telling_->moving = std::move(moving);
}

GripperWork::~GripperWork() {
    forceStop();
}

void GripperWork::start(skill::ExecutionHandle execution) {
    telling_->execution = std::move(execution);
    watchSafety();
    if (auto moved = move(); !moved) {
        telling_->execution.fail(Reason::error, moved.error().message);
    }
}

Result<void> GripperWork::move() {
    telling_->moving->store(true);
    auto asked = ask_(gripper_, [telling = telling_](const auto& outcome) {
        telling->moving->store(false);
        tell(*telling, outcome);
    });
    if (!asked) {
        telling_->moving->store(false);
    }
    return asked;
}

void GripperWork::tell(const Telling& telling, const Result<device::GripperOutcome>& outcome) {
    const auto result = outcome.and_then(telling.judge);
    if (result) {
        telling.execution.finish(*result);
    } else if (result.error().code == Errc::cancelled) {
        telling.execution.atRest();
    } else {
        const bool lost = result.error().code == Errc::connection_lost;
        telling.execution.fail(lost ? Reason::device_lost : Reason::error, result.error().message);
    }
}

/// Watches the gripper's safety state: while the jaws rest, no end of a motion reports a loss.
void GripperWork::watchSafety() {
    safety_watch_ = gripper_.onSafetyChange([telling = telling_](const device::Safety& safety) {
        if (safety.state == SafetyState::normal || telling->moving->load()) {
            return;
        }
        const bool lost = safety.state == SafetyState::disconnected;
        telling->execution.fail(lost ? Reason::device_lost : Reason::error, safety.text);
    });
}

Result<void> GripperWork::suspend() {
    gripper_.stop();
    return {};
}

Result<void> GripperWork::resume() {
    return move();
}

void GripperWork::halt() {
    if (telling_->moving->load()) {
        gripper_.stop();
    } else {
        telling_->execution.atRest();
    }
}

void GripperWork::forceStop() noexcept {
    if (telling_->moving->load()) {
        gripper_.stop();
    }
}

}  // namespace metier::robot_skills
