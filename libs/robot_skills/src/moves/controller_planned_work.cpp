#include "moves/controller_planned_work.hpp"

#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "conversions.hpp"
#include "metier/motion/frame.hpp"
#include "moves/timetable.hpp"

namespace metier::robot_skills {

using device::MotionOutcome;
using skill::Reason;

namespace {

// The controller's end of a motion to joints is this near to them [rad].
constexpr double kArrivedJoints = 5e-3;

}  // namespace

void tellMoveDone(const skill::ExecutionHandle& tell, const MoveResults& results,
                  const MotionOutcome& /*outcome*/) {
    tell.finish(moveResultFields().write(results));
}

// ---- what caller and controller share -----------------------------------------------------------

ControllerPlannedMove::ControllerPlannedMove(Setup setup)
    : setup_(std::move(setup)),
      deviation_(setup_.trajectory, setup_.path),
      acceleration_(setup_.robot.model, setup_.trajectory, setup_.robot.arm.info().cycleSeconds()) {
}

void ControllerPlannedMove::begin(const skill::ExecutionHandle& execution) {
    tell_ = execution;
    stop_asked_.store(false);
    begun_ = setup_.robot.clock.now();
    if (first_begun_ == 0.0) {
        first_begun_ = toSeconds(setup_.robot.clock.utcNow());
    }
    acceleration_.restart();
    noteStop(setup_.robot.arm.state());
    in_motion_.store(true);
}

void ControllerPlannedMove::abandon() noexcept {
    setup_.robot.stopping->clear();
    in_motion_.store(false);
}

void ControllerPlannedMove::observe(const device::ArmState& state) noexcept {
    place_ = deviation_.take(toVector(state.position));
    noteStop(state);
}

void ControllerPlannedMove::noteStop(const device::ArmState& state) noexcept {
    const auto acceleration = acceleration_.take(state, place_);
    setup_.robot.stopping->note(stoppingEstimateOf(state, setup_.robot.model, acceleration));
}

void ControllerPlannedMove::ended(const Result<MotionOutcome>& outcome) {
    moved_ += setup_.robot.clock.now() - begun_;
    last_ended_ = toSeconds(setup_.robot.clock.utcNow());
    rest_ = setup_.robot.arm.state().position;
    setup_.robot.stopping->clear();
    in_motion_.store(false);
    if (!outcome) {
        const bool lost = outcome.error().code == Errc::connection_lost;
        tell_.fail(lost ? Reason::device_lost : Reason::error, outcome.error().message);
    } else if (outcome->end == MotionOutcome::End::stopped) {
        tellStopped();
    } else {
        tellArrived(*outcome);
    }
}

void ControllerPlannedMove::tellStopped() {
    if (!stop_asked_.load()) {
        tell_.fail(Reason::error,
                   setup_.robot.arm.info().name + ": the motion was stopped from outside");
        return;
    }
    const auto tool = setup_.trajectory.toolPose(toVector(rest_));
    tell_.progress(setup_.trajectory.deviation(tool).fraction);
    tell_.atRest();
}

void ControllerPlannedMove::tellArrived(const MotionOutcome& outcome) {
    const bool joints = setup_.end == MoveEnd::joints;
    const double off = device::largestDifference(rest_, toArray(setup_.trajectory.end()));
    if (joints && outcome.end == MotionOutcome::End::at_target && off > kArrivedJoints) {
        tell_.fail(Reason::error,
                   fmt::format("{}: the motion ended in another configuration: an axis is {:.4f} "
                               "rad from its target, limit {} rad",
                               setup_.robot.arm.info().name, off, kArrivedJoints));
        return;
    }
    setup_.tell(tell_, results(rest_), outcome);
}

MoveResults ControllerPlannedMove::results(const device::JointArray& reached) const {
    return {.reached_pose = motion::toFrame(setup_.trajectory.toolPose(toVector(reached))),
            .reached_joint_position = {reached.begin(), reached.end()},
            .duration = moved_.count(),
            .largest_path_deviation = deviation_.largest(),
            .motion_start_time = first_begun_,
            .motion_end_time = last_ended_};
}

// ---- the execution ------------------------------------------------------------------------------

ControllerPlannedWork::ControllerPlannedWork(device::MotionPlanner& planner,
                                             device::ControllerPlannedMotion motion,
                                             ControllerPlannedMove::Setup move)
    : ArmWork(move.robot.arm, toolPoseOf(move.trajectory)),
      planner_(planner),
      motion_(std::move(motion)),
      move_(std::make_shared<ControllerPlannedMove>(std::move(move))) {
    motion_.observer = move_;
}

ControllerPlannedWork::~ControllerPlannedWork() {
    if (move_->inMotion()) {
        planner_.stopMotion();
    }
}

void ControllerPlannedWork::start(skill::ExecutionHandle execution) {
    begin(std::move(execution), [move = move_] { return move->inMotion(); });
    if (auto begun = move(); !begun) {
        const bool lost = begun.error().code == Errc::connection_lost;
        this->execution().fail(lost ? Reason::device_lost : Reason::error, begun.error().message);
    }
}

Result<void> ControllerPlannedWork::move() {
    move_->begin(execution());
    auto begun = planner_.move(
        motion_, [move = move_](const Result<MotionOutcome>& outcome) { move->ended(outcome); });
    if (!begun) {
        move_->abandon();
    }
    return begun;
}

Result<void> ControllerPlannedWork::suspend() {
    move_->stopAsked();
    planner_.stopMotion();
    return {};
}

Result<void> ControllerPlannedWork::resume() {
    METIER_TRY(checkNotMoved(move_->restingPlace()));
    return move();
}

void ControllerPlannedWork::halt() {
    move_->stopAsked();
    if (move_->inMotion()) {
        planner_.stopMotion();
    } else {
        execution().atRest();
    }
}

void ControllerPlannedWork::forceStop() noexcept {
    move_->stopAsked();
    if (move_->inMotion()) {
        arm().stop();
        planner_.stopMotion();
    }
}

}  // namespace metier::robot_skills
