#include "conversation.hpp"

#include <fmt/format.h>

#include <utility>

namespace metier::wsg50_driver {

using device::Safety;
using device::SafetyState;

Conversation::Conversation(const ConversationOptions& options, SteadyTime now,
                           ConversationListener& listener)
    : options_(options), listener_(listener), deadline_(now + options.reply_timeout) {
    listener_.send(stepCommand());
}

Command Conversation::stepCommand() const {
    switch (step_) {
        case Step::limits:
            return Command(CommandId::limits);
        case Step::force_limit:
            return Command(CommandId::get_force_limit);
        case Step::acceleration:
            return accelerationCommand(options_.acceleration);
        case Step::system_state:
            return updateCommand(CommandId::system_state, options_.update_period);
        case Step::grasping_state:
            return updateCommand(CommandId::grasping_state, options_.update_period);
        case Step::width:
            return updateCommand(CommandId::width, options_.update_period);
        case Step::force:
        case Step::done:
            break;
    }
    return updateCommand(CommandId::force, options_.update_period);
}

Result<void> Conversation::take(const Frame& frame, SteadyTime now) {
    METIER_ASSIGN(const auto reply, parseReply(frame));
    if (reply.status == Status::success) {
        METIER_ASSIGN(const auto update, seen_.take(reply, now));
        if (update && started_) {
            listener_.onState(seen_.state(now));
            follow(now);
            return {};
        }
    }
    if (!started_) {
        return takeStart(reply, now);
    }
    takeAnswer(reply, now);
    return {};
}

Result<void> Conversation::takeStart(const Reply& reply, SteadyTime now) {
    if (reply.id != stepCommand().id()) {
        return {};
    }
    METIER_TRY(takeStep(reply));
    nextStep(now);
    return {};
}

Result<void> Conversation::takeStep(const Reply& reply) {
    if (step_ == Step::force_limit) {
        if (const auto force = parseForce(reply.data); force && *force > 0.0) {
            force_limit_ = *force;
        }
        return {};  // it is only a default, for which there is another
    }
    if (reply.status != Status::success) {
        return fail(Errc::device_fault,
                    fmt::format("the gripper refused command {:02X}: {}",
                                static_cast<int>(reply.id), describe(reply.status)));
    }
    if (step_ != Step::limits) {
        return {};
    }
    return parseLimits(reply.data).map([&](const Limits& limits) { limits_ = limits; });
}

void Conversation::nextStep(SteadyTime now) {
    step_ = static_cast<Step>(static_cast<int>(step_) + 1);
    if (step_ == Step::acceleration && options_.acceleration == 0.0) {
        step_ = Step::system_state;
    }
    if (step_ == Step::done) {
        started(now);
        return;
    }
    deadline_ = now + options_.reply_timeout;
    listener_.send(stepCommand());
}

void Conversation::started(SteadyTime now) {
    started_ = true;
    listener_.onLimits(limits_, force_limit_.value_or(limits_.max_force));
    listener_.onState(seen_.state(now));
    const bool acknowledge = options_.acknowledge && seen_.system().fault();
    const bool home =
        options_.home && !seen_.system().referenced() && (acknowledge || !seen_.system().fault());
    if (acknowledge || home) {
        reset(now);
    }
    tellSafety();
}

/// A reply that is no update: to a motion, or to the acknowledgement of a fault.
void Conversation::takeAnswer(const Reply& reply, SteadyTime now) {
    if (settlesDebt(reply)) {
        return;
    }
    if (reply.status == Status::pending) {
        owed_.erase(reply.id);  // it would have come before
    }
    if (motion_) {
        motion_->take(reply, seen_, now);
    }
    if (acknowledged_ && reply.id == CommandId::acknowledge) {
        acknowledged_ = seen_.mark();
        if (reply.status != Status::success) {
            acknowledged_.reset();
            endReset(fail(Errc::device_fault,
                          "the gripper refused to acknowledge: " + describe(reply.status)));
        }
    }
    follow(now);
}

/// Reports whether this is the last reply of a motion that was given up before the reply came.
bool Conversation::settlesDebt(const Reply& reply) {
    const bool last = reply.status == Status::success || reply.status == Status::aborted ||
                      reply.status == Status::command_failed || reply.status == Status::blocked;
    return last && owed_.erase(reply.id) > 0;
}

Result<void> Conversation::tick(SteadyTime now) {
    if (!started_) {
        if (now < deadline_) {
            return {};
        }
        return fail(Errc::timeout, fmt::format("no answer to command {:02X} within {} ms",
                                               static_cast<int>(stepCommand().id()),
                                               options_.reply_timeout.count()));
    }
    const auto longest = options_.update_period * options_.silence_periods;
    if (const auto silent = seen_.silentValue(now, longest)) {
        return fail(Errc::timeout,
                    fmt::format("no update of the {} for {} ms", *silent, longest.count()));
    }
    follow(now);
    return {};
}

void Conversation::begin(const Motion& motion, SteadyTime now) {
    motion_.emplace(motion,
                    MotionTask::Timing{options_.reply_timeout, options_.motion_timeout,
                                       options_.settle_timeout},
                    now, listener_);
}

void Conversation::stop(SteadyTime now) {
    if (motion_) {
        motion_->stop(now);
    }
}

void Conversation::reset(SteadyTime now) {
    if (resetting_) {
        return;
    }
    resetting_ = true;
    reset_deadline_ = now + options_.reply_timeout;
    if (seen_.system().fault()) {
        acknowledged_ = seen_.mark();
        listener_.send(acknowledgeCommand());
    }
    follow(now);
}

/// Acts on what the last reply or update has changed.
void Conversation::follow(SteadyTime now) {
    if (motion_) {
        if (auto outcome = motion_->outcome(seen_, now)) {
            endMotion(std::move(*outcome));
        }
    }
    if (resetting_ && !motion_) {
        followReset(now);
    }
    tellSafety();
}

void Conversation::endMotion(Result<device::GripperOutcome> outcome) {
    if (const auto owed = motion_->owed()) {
        owed_.insert(*owed);
    }
    const auto kind = motion_->kind();
    motion_.reset();
    if (kind != MotionKind::home) {
        tellSafety();
        listener_.onMotionEnd(std::move(outcome));
    } else if (!outcome) {
        endReset(fail(std::move(outcome.error())));
    }
}

void Conversation::followReset(SteadyTime now) {
    if (acknowledged_ && (seen_.system().fault() || !seen_.renewedSince(*acknowledged_))) {
        if (now >= reset_deadline_) {
            acknowledged_.reset();
            endReset(fail(Errc::device_fault,
                          "acknowledged, but there is still: " + seen_.system().faultText()));
        }
        return;
    }
    acknowledged_.reset();
    if (seen_.system().fault()) {
        endReset(fail(Errc::device_fault, seen_.system().faultText()));
    } else if (!seen_.system().referenced()) {
        begin({.kind = MotionKind::home}, now);
    } else {
        endReset({});
    }
}

void Conversation::endReset(Result<void> outcome) {
    resetting_ = false;
    tellSafety();
    listener_.onResetEnd(std::move(outcome));
}

void Conversation::tellSafety() {
    auto now = judgeSafety();
    if (now.state == safety_.state && now.text == safety_.text) {
        return;
    }
    safety_ = std::move(now);
    listener_.onSafety(safety_);
}

Safety Conversation::judgeSafety() const {
    if (seen_.system().fault()) {
        return {SafetyState::fault, seen_.system().faultText() + ": Reset acknowledges it", false};
    }
    if (motion_ && motion_->kind() == MotionKind::home) {
        return {SafetyState::fault, "homing: the jaws move", false};
    }
    if (!seen_.system().referenced()) {
        return {SafetyState::fault, "not referenced: Reset homes it, which moves the jaws", false};
    }
    return {};
}

}  // namespace metier::wsg50_driver
