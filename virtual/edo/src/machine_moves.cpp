#include "machine.hpp"

namespace metier::virtual_edo {
namespace {

constexpr std::size_t kMostQueuedMoves = 5;

bool isValid(const Movement& movement) {
    using namespace move_command;
    if (movement.command == kPause || movement.command == kResume || movement.command == kCancel) {
        return true;
    }
    const bool type = movement.type == move_type::kJoint || movement.type == move_type::kLinear ||
                      movement.type == move_type::kCircular;
    const auto point = movement.target.data_type;
    return movement.command == kMove && type &&
           (point == point_type::kJoint || point == point_type::kCartesian ||
            point == point_type::kExtended);
}

bool sameJog(const Movement& first, const Movement& second) {
    if (second.type == move_type::kJoint) {
        return first.target.joints == second.target.joints;
    }
    return first.target.pose == second.target.pose;
}

}  // namespace

void Machine::onMove(const Movement& movement) {
    if (state_ == MachineState::calibrated) {
        move_phase_ = MovePhase::idle;
        moves_.clear();
    } else if (state_ != MachineState::move) {
        return;
    }
    if (!isValid(movement)) {
        say(FeedbackType::rejected);
        return;
    }
    enter(MachineState::move);
    switch (movement.command) {
        case move_command::kPause:
            pause(movement);
            break;
        case move_command::kCancel:
            cancel();
            break;
        case move_command::kResume:
            resume(movement);
            break;
        default:
            startMove(movement);
            break;
    }
}

void Machine::startMove(const Movement& movement) {
    if (move_phase_ != MovePhase::idle) {
        queueMove(movement);
        return;
    }
    moves_.push_back(movement);
    passNext();
    say(FeedbackType::received);
}

void Machine::queueMove(const Movement& movement) {
    say(FeedbackType::received);
    if (moves_.size() < kMostQueuedMoves) {
        moves_.push_back(movement);
        return;
    }
    say(FeedbackType::executed, FeedbackData::dropped_buffer_full);
    say(FeedbackType::buffer_full);
}

void Machine::passNext() {
    const Movement next = moves_.front();
    moves_.pop_front();
    peers_.passMove(next);
}

void Machine::pause(const Movement& movement) {
    say(FeedbackType::received);
    if (move_phase_ == MovePhase::idle) {
        move_phase_ = MovePhase::pause;
        peers_.passMove(movement);
    }
}

void Machine::resume(const Movement& movement) {
    if (move_phase_ == MovePhase::cancel) {
        say(FeedbackType::rejected);
        return;
    }
    say(FeedbackType::received);
    if (move_phase_ == MovePhase::pause) {
        move_phase_ = MovePhase::idle;
        peers_.passMove(movement);
    }
}

void Machine::cancel() {
    say(FeedbackType::received);
    for (; !moves_.empty(); moves_.pop_front()) {
        say(FeedbackType::executed, FeedbackData::dropped_by_cancel);
    }
    if (move_phase_ == MovePhase::cancel) {
        return;
    }
    // The robot first pauses what moves; when that is done it cancels.
    move_phase_ = MovePhase::cancel;
    peers_.passMove(Movement{.command = move_command::kPause});
}

void Machine::onFeedback(Feedback feedback) {
    if (state_ == MachineState::not_calibrated) {
        peers_.publishFeedback(feedback);
        return;
    }
    if (state_ != MachineState::calibrated && state_ != MachineState::move) {
        return;  // it is not forwarded
    }
    if (feedback.type == FeedbackType::executed) {
        onExecuted(feedback);
        return;
    }
    if (feedback.type == FeedbackType::need_data) {
        onNeedData(feedback);
        return;
    }
    peers_.publishFeedback(feedback);
    enter(MachineState::calibrated);
}

void Machine::onNeedData(Feedback feedback) {
    if (state_ == MachineState::move && move_phase_ != MovePhase::idle) {
        return;
    }
    peers_.publishFeedback(feedback);
    if (state_ == MachineState::move && !moves_.empty()) {
        passNext();
    }
}

void Machine::onExecuted(Feedback feedback) {
    if (state_ == MachineState::move && move_phase_ == MovePhase::cancel) {
        enter(MachineState::calibrated);
        move_phase_ = MovePhase::idle;
        peers_.passMove(Movement{.command = move_command::kCancel});
        return;
    }
    peers_.publishFeedback(feedback);
    if (state_ != MachineState::move || move_phase_ != MovePhase::idle) {
        return;
    }
    if (!moves_.empty()) {
        passNext();
    } else if (!peers_.algorithmBusy()) {
        enter(MachineState::calibrated);
    }
}

void Machine::onJog(const Movement& movement) {
    const bool may_begin =
        state_ == MachineState::calibrated ||
        (state_ == MachineState::not_calibrated && movement.type == move_type::kJoint);
    if (state_ == MachineState::jog) {
        const bool same =
            movement.command == move_command::kJog && jog_ && sameJog(*jog_, movement);
        jog_age_ = 0;
        if (!same) {
            stopJog();
        }
        return;
    }
    if (!may_begin || movement.command != move_command::kJog ||
        (movement.type != move_type::kJoint && movement.type != move_type::kLinear)) {
        return;
    }
    previous_ = state_;
    enter(MachineState::jog);
    jog_ = movement;
    jog_age_ = 0;
    peers_.passJog(movement);
}

void Machine::stopJog() {
    enter(previous_);
    jog_.reset();
    peers_.passJog(Movement{.command = move_command::kJogStop});
}

}  // namespace metier::virtual_edo
