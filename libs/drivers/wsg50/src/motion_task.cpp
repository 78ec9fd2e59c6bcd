#include "motion_task.hpp"

#include <fmt/format.h>

#include <cmath>
#include <string_view>
#include <utility>

#include "metier/base/numbers.hpp"

namespace metier::wsg50_driver {
namespace {

// Largest distance of the jaws from their commanded width.
constexpr double kWidthTolerance = 1.0 * kMillimetre;

Command commandFor(const Motion& motion) {
    switch (motion.kind) {
        case MotionKind::grasp:
            return graspCommand(motion.width, motion.speed);
        case MotionKind::release:
            return releaseCommand(motion.width, motion.speed);
        case MotionKind::move:
            return positionCommand(motion.width, motion.speed);
        case MotionKind::home:
            break;
    }
    return homeCommand();
}

std::string_view nameOf(MotionKind kind) {
    switch (kind) {
        case MotionKind::grasp:
            return "grasp";
        case MotionKind::release:
            return "release";
        case MotionKind::move:
            return "move";
        case MotionKind::home:
            break;
    }
    return "homing";
}

/// Reports whether this status ends a pending motion, rather than refusing a new one.
bool endsMotion(Status status) {
    return status == Status::success || status == Status::command_failed ||
           status == Status::aborted || status == Status::blocked;
}

}  // namespace

MotionTask::MotionTask(Motion motion, const Timing& timing, SteadyTime now, CommandSink& sink)
    : motion_(motion), timing_(timing), sink_(sink), deadline_(now + timing.reply) {
    if (motion_.kind == MotionKind::home) {
        begin(now);
    } else {
        sink_.send(forceLimitCommand(motion_.force));
    }
}

void MotionTask::begin(SteadyTime now) {
    phase_ = Phase::asked;
    deadline_ = now + timing_.reply;
    sink_.send(commandFor(motion_));
}

void MotionTask::take(const Reply& reply, const Observation& seen, SteadyTime now) {
    if (phase_ == Phase::force_limit && reply.id == CommandId::set_force_limit) {
        takeForceLimit(reply.status, now);
        return;
    }
    const bool waiting = phase_ == Phase::asked || phase_ == Phase::pending;
    if (!waiting || reply.id != commandFor(motion_).id()) {
        return;
    }
    if (reply.status == Status::pending) {
        phase_ = Phase::pending;
        deadline_ = stopping_ ? deadline_ : now + timing_.motion;
    } else if (endsMotion(reply.status)) {
        settle(reply.status, seen, now);
    } else {
        refuse(fmt::format("{} refused: {}", nameOf(motion_.kind), describe(reply.status)));
    }
}

void MotionTask::takeForceLimit(Status status, SteadyTime now) {
    if (status != Status::success) {
        refuse(fmt::format("force limit of {} N refused: {}", motion_.force, describe(status)));
        return;
    }
    if (stopping_) {
        settle(Status::aborted, {}, now);
        return;
    }
    begin(now);
}

void MotionTask::settle(Status last, const Observation& seen, SteadyTime now) {
    phase_ = Phase::settling;
    last_ = last;
    mark_ = seen.mark();
    deadline_ = now + timing_.settle;
    rest_by_ = now + timing_.motion;
}

void MotionTask::refuse(std::string why) {
    phase_ = Phase::refused;
    refusal_ = std::move(why);
}

void MotionTask::stop(SteadyTime now) {
    if (stopping_) {
        return;
    }
    stopping_ = true;
    if (phase_ == Phase::asked || phase_ == Phase::pending) {
        deadline_ = now + timing_.reply;
        sink_.send(Command(CommandId::stop));
    }
}

std::optional<CommandId> MotionTask::owed() const noexcept {
    return phase_ == Phase::asked || phase_ == Phase::pending
               ? std::optional(commandFor(motion_).id())
               : std::nullopt;
}

std::optional<MotionTask::Outcome> MotionTask::outcome(const Observation& seen, SteadyTime now) {
    if (phase_ == Phase::refused) {
        return fail(Errc::device_fault, refusal_);
    }
    if (seen.system().fault()) {
        return fail(Errc::device_fault,
                    fmt::format("{} ended by the gripper: {}", nameOf(motion_.kind),
                                seen.system().faultText()));
    }
    if (phase_ == Phase::settling && seen.system().moving() && now < rest_by_) {
        deadline_ = now + timing_.settle;  // counted from standstill
        return std::nullopt;
    }
    if (phase_ == Phase::settling && seen.renewedSince(mark_) && !seen.system().moving() &&
        (last_ != Status::success || asWanted(seen))) {
        return graspsAnew(seen, now) ? std::nullopt : std::optional(judge(seen));
    }
    return now < deadline_ ? std::nullopt : late(seen, now);
}

/// Grasps again at the width of the blockage: the gripper detects a part only near the commanded
/// width.
bool MotionTask::graspsAnew(const Observation& seen, SteadyTime now) {
    if (!motion_.any_width || last_ != Status::blocked || seen.partHeld() || stopping_) {
        return false;
    }
    motion_.any_width = false;
    motion_.width = seen.width();
    begin(now);
    return true;
}

/// Outcome when the time for the present phase is over.
std::optional<MotionTask::Outcome> MotionTask::late(const Observation& seen, SteadyTime now) {
    const bool settling = phase_ == Phase::settling;
    if ((settling || stopping_) && seen.system().moving()) {
        return fail(Errc::timeout,
                    fmt::format("the jaws still move after {}",
                                stopping_ ? std::string("stop")
                                          : fmt::format("the end of {}", nameOf(motion_.kind))));
    }
    if (settling) {
        return judge(seen);
    }
    if (stopping_) {
        return stopped();
    }
    if (phase_ == Phase::pending) {
        timed_out_ = true;
        stop(now);
        return std::nullopt;
    }
    return fail(Errc::timeout, fmt::format("no answer to {} in time", nameOf(motion_.kind)));
}

MotionTask::Outcome MotionTask::stopped() const {
    return timed_out_
               ? fail(Errc::timeout, fmt::format("{} did not end in time", nameOf(motion_.kind)))
               : fail(Errc::cancelled, "stopped");
}

/// Reports whether the state is the one after a successful motion.
bool MotionTask::asWanted(const Observation& seen) const {
    switch (motion_.kind) {
        case MotionKind::grasp:
            return seen.partHeld();
        case MotionKind::release:
            return seen.grasping() == GraspingState::idle;
        case MotionKind::move:
            return std::abs(seen.width() - motion_.width) <= kWidthTolerance;
        case MotionKind::home:
            break;
    }
    return seen.system().referenced();
}

MotionTask::Outcome MotionTask::judge(const Observation& seen) const {
    // A part may stop the jaws before its nominal width: held is held.
    const bool held = motion_.kind == MotionKind::grasp && last_ == Status::blocked;
    if ((last_ == Status::success || held) && asWanted(seen)) {
        return device::GripperOutcome{seen.width(), seen.partHeld()};
    }
    if (stopping_) {
        return stopped();
    }
    return last_ == Status::success ? judgeMismatch(seen) : judgeFailure(seen);
}

MotionTask::Outcome MotionTask::judgeFailure(const Observation& seen) const {
    const double width_mm = seen.width() / kMillimetre;
    if (motion_.kind == MotionKind::grasp && seen.grasping() == GraspingState::part_lost) {
        return fail(Errc::device_fault, fmt::format("the part was lost at {:.1f} mm", width_mm));
    }
    if (last_ == Status::blocked) {
        return fail(Errc::device_fault,
                    fmt::format("{} blocked at {:.1f} mm", nameOf(motion_.kind), width_mm));
    }
    if (last_ == Status::aborted) {
        return fail(Errc::device_fault, fmt::format("{} was aborted by someone else at {:.1f} mm",
                                                    nameOf(motion_.kind), width_mm));
    }
    if (motion_.kind == MotionKind::grasp) {
        return fail(Errc::device_fault,
                    fmt::format("no part found: the jaws closed to {:.1f} mm", width_mm));
    }
    return fail(Errc::device_fault,
                fmt::format("{} failed at {:.1f} mm", nameOf(motion_.kind), width_mm));
}

/// Outcome if the gripper reported success but its state differs.
MotionTask::Outcome MotionTask::judgeMismatch(const Observation& seen) const {
    const double width_mm = seen.width() / kMillimetre;
    if (motion_.kind == MotionKind::grasp && (seen.grasping() == GraspingState::no_part ||
                                              seen.grasping() == GraspingState::part_lost)) {
        return judgeFailure(seen);
    }
    if (motion_.kind == MotionKind::move) {
        return fail(
            Errc::device_fault,
            fmt::format("the gripper reported success, but the jaws are at {:.1f} mm instead "
                        "of {:.1f} mm",
                        width_mm, motion_.width / kMillimetre));
    }
    return fail(
        Errc::device_fault,
        fmt::format("the gripper reported success of {}, but its state is '{}' at {:.1f} mm",
                    nameOf(motion_.kind), toString(seen.grasping()), width_mm));
}

}  // namespace metier::wsg50_driver
