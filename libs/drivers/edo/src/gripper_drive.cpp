#include "gripper_drive.hpp"

#include <algorithm>
#include <cmath>

#include "machine_text.hpp"

namespace metier::edo_driver {
namespace {

using namespace std::chrono_literals;

constexpr auto kGripperBeginTime = 500ms;  // longest time from a motion's command to its begin
constexpr auto kCancelTime = 2s;
constexpr auto kRestTime = 100ms;    // standstill of the jaws that ends a motion
constexpr auto kStallTime = 500ms;   // standstill of the jaws while the robot takes them for moving
constexpr double kRestSpeed = 1e-3;  // [m/s]
constexpr double kArrived = 1e-3;    // [m]
constexpr double kMoved = 0.5e-3;    // [m]

double inMillimetres(double metres) {
    return metres * 1e3;
}

Result<int> overrideFor(const std::optional<double>& speed, const GripperOptions& options) {
    if (!speed) {
        return 100;
    }
    if (!(*speed > 0.0 && *speed <= options.speed)) {
        return fail(Errc::out_of_range,
                    fmt::format("speed {} m/s is not within 0 and {} m/s", *speed, options.speed));
    }
    return std::clamp(static_cast<int>(std::lround(*speed / options.speed * 100.0)), 1, 100);
}

/// A part is squeezed by jaws that would go on, since there is no force to ask for.
double targetFor(GripperTask::Kind kind, const std::optional<double>& width,
                 const GripperOptions& options) {
    if (kind == GripperTask::Kind::grasp) {
        return std::max(0.0, width.value_or(0.0) - 2.0 * options.grasp_shortfall);
    }
    return width.value_or(options.stroke);
}

}  // namespace

Result<GripperTask> taskFor(GripperTask::Kind kind, const device::GripperRequest& request,
                            const GripperOptions& options) {
    if (request.force.value_or(0.0) != 0.0) {
        return fail(Errc::not_supported,
                    fmt::format("force {} N: this gripper has no force control", *request.force));
    }
    if (request.width && !(*request.width >= 0.0 && *request.width <= options.stroke)) {
        return fail(Errc::out_of_range, fmt::format("width {} m is not within 0 and {} m",
                                                    *request.width, options.stroke));
    }
    if (kind == GripperTask::Kind::move && !request.width) {
        return fail(Errc::invalid_argument, "a width to move to is missing");
    }
    METIER_ASSIGN(auto percent, overrideFor(request.speed, options));
    return GripperTask{kind, targetFor(kind, request.width, options), percent};
}

void GripperDrive::start(const GripperTask& task, const JointSetPoint& holding, SteadyTime now,
                         Wire& wire) {
    step_ = Step::sent;
    task_ = task;
    start_width_ = width_;
    begin_by_ = now + kGripperBeginTime;
    deadline_ = now + options_.gripper.timeout;
    executed_ = false;
    rejection_.clear();
    held_at_.reset();
    JointMove move{holding, task.override_percent};
    move.target.position[options_.layout.axes] = task.target;
    wire.send(moveText(options_.layout, move));
}

void GripperDrive::stop(SteadyTime now, Wire& wire) {
    if (step_ == Step::sent || step_ == Step::moving) {
        step_ = Step::cancelling;
        deadline_ = now + kCancelTime;
        resting_since_ = now;
        wire.send(cancelText());
    }
}

void GripperDrive::onFeedback(const MovementFeedback& feedback) {
    if (step_ != Step::sent && step_ != Step::moving) {
        return;
    }
    executed_ = executed_ || feedback.type == MovementFeedback::executed;
    if (feedback.type < 0) {
        const std::string_view kind = feedback.type == MovementFeedback::rejected ? "rejected"
                                      : feedback.type == MovementFeedback::buffer_full
                                          ? "buffer full"
                                          : "error";
        rejection_ = fmt::format("{}, code {}", kind, feedback.data);
    }
}

void GripperDrive::onJoint(const JointSample& jaws, SteadyTime now) noexcept {
    width_ = jaws.position;
    current_ = std::isfinite(jaws.current) ? jaws.current : 0.0;
    const bool resting = !(std::abs(jaws.velocity) > kRestSpeed);
    if (resting && !resting_) {
        resting_since_ = now;
    }
    resting_ = resting;
    if (held_at_ && std::abs(width_ - *held_at_) > options_.gripper.grasp_shortfall) {
        held_at_.reset();
    }
}

bool GripperDrive::restingFor(Duration duration, SteadyTime now) const noexcept {
    return resting_ && now - resting_since_ >= duration;
}

GripperDrive::Ended GripperDrive::failed(Errc code, const std::string& why) {
    step_ = Step::idle;
    return Result<device::GripperOutcome>(fail(code, options_.name + " gripper: " + why));
}

GripperDrive::Ended GripperDrive::tick(const MachineState& machine, SteadyTime now, Wire& wire) {
    switch (step_) {
        case Step::idle:
            return std::nullopt;
        case Step::sent:
            return tickSent(machine, now);
        case Step::moving:
            return tickMoving(machine, now, wire);
        case Step::cancelling:
            return tickCancelling(machine, now);
    }
    return std::nullopt;
}

GripperDrive::Ended GripperDrive::tickSent(const MachineState& machine, SteadyTime now) {
    if (!rejection_.empty()) {
        return failed(Errc::device_fault, "the robot refused the motion: " + rejection_);
    }
    const bool there = std::abs(width_ - task_.target) < kArrived;
    if (machine.state == MachineState::move || std::abs(width_ - start_width_) > kMoved ||
        (executed_ && there)) {
        step_ = Step::moving;
        resting_since_ = now;
        return std::nullopt;
    }
    if (now < begin_by_) {
        return std::nullopt;
    }
    if (there) {
        step_ = Step::idle;
        return judge();
    }
    return failed(Errc::device_fault,
                  fmt::format("the robot dropped the motion without a word: {}, jaws at {:.1f} mm",
                              toText(machine), inMillimetres(width_)));
}

GripperDrive::Ended GripperDrive::tickMoving(const MachineState& machine, SteadyTime now,
                                             Wire& wire) {
    if (!rejection_.empty()) {
        return failed(Errc::device_fault, "the robot gave the motion up: " + rejection_);
    }
    const bool ready = machine.state != MachineState::move;
    if (ready && restingFor(kRestTime, now)) {
        step_ = Step::idle;
        return judge();
    }
    if (!ready && restingFor(kStallTime, now) && now >= begin_by_) {
        // A part blocks the jaws; the robot must not wait for them.
        auto outcome = judge();
        wire.send(cancelText());
        step_ = Step::idle;
        return outcome;
    }
    if (now >= deadline_) {
        wire.send(cancelText());
        return failed(Errc::timeout,
                      fmt::format("jaws at {:.1f} mm of {:.1f} mm, {}", inMillimetres(width_),
                                  inMillimetres(task_.target), toText(machine)));
    }
    return std::nullopt;
}

GripperDrive::Ended GripperDrive::tickCancelling(const MachineState& machine, SteadyTime now) {
    if (machine.state != MachineState::move && restingFor(kStallTime, now)) {
        return failed(Errc::cancelled, "stopped");
    }
    if (now >= deadline_) {
        return failed(Errc::device_fault, fmt::format("does not stop: {}, jaws at {:.1f} mm",
                                                      toText(machine), inMillimetres(width_)));
    }
    return std::nullopt;
}

Result<device::GripperOutcome> GripperDrive::judge() {
    const auto& gripper = options_.gripper;
    const bool held = width_ - task_.target > gripper.grasp_shortfall &&
                      std::abs(current_) >= gripper.grasp_current;
    if (task_.kind == GripperTask::Kind::grasp && !held) {
        return *failed(
            Errc::device_fault,
            fmt::format("no part found: the jaws closed to {:.1f} mm", inMillimetres(width_)));
    }
    if (task_.kind == GripperTask::Kind::release &&
        std::abs(width_ - task_.target) > gripper.grasp_shortfall) {
        return *failed(Errc::device_fault,
                       fmt::format("blocked: the jaws opened to {:.1f} mm of {:.1f} mm",
                                   inMillimetres(width_), inMillimetres(task_.target)));
    }
    if (held) {
        held_at_ = width_;
    }
    return device::GripperOutcome{width_, held};
}

}  // namespace metier::edo_driver
