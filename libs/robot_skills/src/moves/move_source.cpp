#include "moves/move_source.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "conversions.hpp"
#include "metier/motion/frame.hpp"
#include "moves/source_work.hpp"
#include "moves/stop_time.hpp"

namespace metier::robot_skills {

namespace {

// Duration of the way back to the path after a rest [s]. kMovedTolerance (arm_work.hpp) in this
// time is at most 0.02 rad/s and 0.3 rad/s2, which every arm can do.
constexpr double kWayBack = 0.2;

}  // namespace

std::unique_ptr<skill::ExecutionWork> makeStreamedWork(const MovedArm& arm, StreamedMove move) {
    auto tool_pose = toolPoseOf(move.trajectory);
    return std::make_unique<SourceWork>(arm.arm, std::make_shared<MoveSource>(arm, std::move(move)),
                                        std::move(tool_pose));
}

MoveSource::MoveSource(const MovedArm& arm, StreamedMove move)
    : arm_(arm.arm.info().name),
      cycle_(arm.arm.info().cycleSeconds()),
      stop_time_(stopTimeFor(move.trajectory, arm.model, move.parameters.stop_time)),
      execution_(move.trajectory),
      stopping_(arm.stopping),
      timetable_(arm.clock, move.parameters.start_time),
      deviation_(move.trajectory, move.path),
      contact_(std::move(move.contact)),
      offset_(arm.arm.info().axisCount()),
      way_back_(kWayBack) {}

device::JointArray MoveSource::restingPlace() const noexcept {
    return toArray(execution_.current().position);
}

void MoveSource::goOnFrom(const device::JointArray& from) {
    const auto rest = restingPlace();
    for (std::size_t axis = 0; axis < offset_.size(); ++axis) {
        offset_[axis] = from[axis] - rest[axis];
    }
    way_back_ = from == rest ? kWayBack : 0.0;
    stop_asked_ = false;
    outcome_ = Outcome::none;
    settling_.restart();
    timetable_.restart();
    execution_.resume();
}

device::SetPointSource::Next MoveSource::next(const device::ArmState& state,
                                              device::JointArray& set_point) noexcept {
    obey();
    watchContact(state);
    measure(state);
    if (way_back_ < kWayBack) {
        way_back_ += cycle_;
        in_motion_ += cycle_;
        set_point = wayBack();
        return Next::set_point;
    }
    if (execution_.finished() || (stop_asked_ && execution_.atRest())) {
        return settle(state);
    }
    set_point = restingPlace();
    switch (timetable_.look()) {
        case Timetable::Due::not_yet:
            return Next::set_point;
        case Timetable::Due::missed:
            outcome_ = Outcome::missed;
            return Next::done;
        case Timetable::Due::now:
            break;
    }
    const double step = timetable_.step(cycle_);
    in_motion_ += step;
    set_point = toArray(execution_.next(motion::Seconds(step)).position);
    stopping_->note(execution_.stoppingEstimate());
    return Next::set_point;
}

void MoveSource::obey() noexcept {
    const auto request = takeRequest();
    if (request == Request::none) {
        return;
    }
    stop_asked_ = true;
    if (request == Request::halt) {
        execution_.halt();
    } else if (stop_time_ > 0.0) {
        execution_.stopIn(motion::Seconds(stop_time_));
    } else {
        execution_.stop();
    }
}

/// Beyond a limit it brakes at once and harder than for a stop, and does not go on.
void MoveSource::watchContact(const device::ArmState& state) noexcept {
    if (!contact_ || in_contact_ || !contact_->mustEnd(state)) {
        return;
    }
    in_contact_ = true;
    stop_asked_ = true;
    execution_.halt();
}

void MoveSource::measure(const device::ArmState& state) noexcept {
    reached_ = state.position;
    deviation_.take(toVector(state.position));
}

device::SetPointSource::Next MoveSource::settle(const device::ArmState& state) noexcept {
    if (in_contact_ && state.standstill) {
        outcome_ = Outcome::in_contact;  // the touched object may keep it off its set-point
        return Next::done;
    }
    switch (settling_.take(state, restingPlace(), cycle_)) {
        case Settling::Status::waiting:
            return Next::set_point;  // the one it holds
        case Settling::Status::arrived:
            outcome_ = execution_.finished() ? Outcome::finished : Outcome::at_rest;
            break;
        case Settling::Status::off_target:
            outcome_ = Outcome::off_target;
            break;
    }
    return Next::done;
}

device::JointArray MoveSource::wayBack() const noexcept {
    const double time = std::min(way_back_ / kWayBack, 1.0);
    const double done = time * time * time * (10.0 + time * (6.0 * time - 15.0));
    auto place = restingPlace();
    for (std::size_t axis = 0; axis < offset_.size(); ++axis) {
        place[axis] += (1.0 - done) * offset_[axis];
    }
    return place;
}

MoveResults MoveSource::results() const {
    MoveResults results;
    results.reached_pose = motion::toFrame(execution_.trajectory().toolPose(toVector(reached_)));
    results.reached_joint_position.assign(reached_.begin(), reached_.end());
    results.duration = in_motion_;
    results.largest_path_deviation = deviation_.largest();
    results.motion_start_time = timetable_.firstTime();
    results.motion_end_time = timetable_.lastTime();
    results.largest_lateness = timetable_.largestLateness();
    return results;
}

void MoveSource::released() noexcept {
    stopping_->clear();
}

void MoveSource::tellDone(const skill::ExecutionHandle& tell) {
    switch (outcome_) {
        case Outcome::in_contact:
            contact_->tell(tell, results());
            return;
        case Outcome::finished:
            if (contact_) {
                contact_->tell(tell, results());
                return;
            }
            tell.finish(moveResultFields().write(results()));
            return;
        case Outcome::none:
        case Outcome::at_rest:
            tell.progress(execution_.pathParameter());
            tell.atRest();
            return;
        case Outcome::off_target:
            settling_.tellOffTarget(tell);
            return;
        case Outcome::missed:
            tell.fail(skill::Reason::error,
                      fmt::format("{}: ready to move {:.3f} s after StartTime, limit {} s", arm_,
                                  timetable_.missedBy(), Timetable::kLatestStart));
            return;
    }
}

}  // namespace metier::robot_skills
