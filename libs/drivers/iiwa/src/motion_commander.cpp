#include "motion_commander.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "commands.hpp"
#include "metier/motion/frame.hpp"
#include "metier/motion/rotation.hpp"
#include "motion_check.hpp"

namespace metier::iiwa_driver {

using device::EndCause;
using device::SafetyState;

namespace {

// A commanded position is kept while the arm is this near [rad].
constexpr double kHeld = 2e-3;
// Most set-points that are left out after late cycles, so that a stream keeps its time.
constexpr std::uint64_t kMostSkipped = 4;
// A setting that was refused is tried again after this time [s].
constexpr double kTryAgain = 1.0;

}  // namespace

MotionCommander::MotionCommander(device::ArmInfo info, const motion::RobotModel& model,
                                 const IiwaOptions& options)
    : core_(std::move(info)),
      model_(model),
      options_(options),
      servo_(model, core_.info().cycleSeconds()) {
    state_ = core_.state();
}

// ---- connection --------------------------------------------------------------------------------

void MotionCommander::connected(const CabinetState& first, SteadyTime now) {
    settings_.forget();
    readiness_ = Readiness();
    flange_from_tool_ = motion::Pose::identity();
    last_answer_ = now;
    state_.cycle = 0;
    state_.missed_cycles = 0;
    holds_ = false;
    try_again_in_ = 0.0;
    condition_ = Condition::none;
    latched_.store(false);
    note(first, now);
    settleIn();
}

/// Sends the first settings to the cabinet, before anything else; none of them moves the arm.
void MotionCommander::settleIn() noexcept {
    mode_ = Mode::settling_in;
    chores_.clear();
    chores_.add(asynchronousExecution());
    chores_.add(chooseInterface(Interface::standard));
    chores_.add(positionControl());
    if (options_.tool >= 0) {
        chores_.add(attachTool(options_.tool));
    }
}

void MotionCommander::takeSettingIn(const Command& sent, const CabinetState& answer) {
    if (sent.code == Code::state) {
        return;
    }
    if (!answer.executed) {
        try_again_in_ = kTryAgain;
        change(Condition::refused_setting, fmt::format("the cabinet refused: {}", describe(sent)));
        return;
    }
    settings_.taken(sent);
    chores_.drop();
    if (chores_.empty()) {
        settledIn(answer);
    }
}

/// The arm is ready for motions, unless it is not the one that the model describes.
void MotionCommander::settledIn(const CabinetState& answer) {
    mode_ = Mode::idle;
    const auto joints = motion::JointVector::from(answer.position.values());
    const auto flange = model_.kinematics().forward(*joints);
    const auto pose = motion::toPose(answer.pose);
    if (options_.tool >= 0) {
        flange_from_tool_ = flange.inverse() * pose;
    } else if (auto same = checkSameFlange(flange, pose); !same) {
        change(Condition::wrong_model, same.error().message);
        return;
    }
    condition_ = Condition::none;
    core_.setSafety({SafetyState::normal, "", false});
}

void MotionCommander::lost(const std::string& text) {
    const std::lock_guard admission(admission_);  // nothing that is admitted now may begin later
    {
        const std::lock_guard lock(lost_mutex_);
        lost_text_ = text;
    }
    core_.setSafety({SafetyState::disconnected, text, false});
    condition_ = Condition::none;
    mode_ = Mode::settling_in;
    core_.publish(state_);
    core_.end(EndCause::disconnected);
    RunEnd end;
    end.cause = RunEnd::Cause::disconnected;
    slot_.end(end);
}

// ---- cycle -------------------------------------------------------------------------------------

Command MotionCommander::command() noexcept {
    if (mode_ == Mode::settling_in) {
        return try_again_in_ > 0.0 ? askState() : chores_.front();
    }
    if (mode_ == Mode::idle) {
        if (!chores_.empty()) {
            return chores_.front();
        }
        beginWhatIsAsked();
    }
    if (mode_ == Mode::planned) {
        if (slot_.takeStop()) {
            planned_.stop(RunEnd::Cause::stopped);
        }
        return planned_.command();
    }
    auto* source = core_.active();
    if (mode_ != Mode::servo || source == nullptr) {
        return askState();
    }
    if (core_.stopRequested()) {
        servo_.stop();
    }
    return servo_.command(*source, state_, 1 + std::exchange(skipped_, 0));
}

void MotionCommander::beginWhatIsAsked() noexcept {
    if (const auto* motion = slot_.posted()) {
        mode_ = Mode::planned;
        planned_.begin({*motion, flange_from_tool_, options_.force_tolerance}, answer_, settings_);
    } else if (core_.active() != nullptr) {
        mode_ = Mode::servo;
        skipped_ = 0;
        servo_.begin(state_.commanded_position, settings_);
    }
}

void MotionCommander::take(const Command& sent, const CabinetState& answer,
                           SteadyTime now) noexcept {
    const double step = std::chrono::duration<double>(now - last_answer_).count();
    last_answer_ = now;
    note(answer, now);
    readiness_.take(answer, step);
    bool motion_over = false;
    std::optional<EndCause> stream_over;
    switch (mode_) {
        case Mode::settling_in:
            try_again_in_ = std::max(0.0, try_again_in_ - step);
            takeSettingIn(sent, answer);
            break;
        case Mode::idle:
            takeChore(sent, answer);
            break;
        case Mode::planned:
            motion_over = takePlanned(sent, answer, step);
            break;
        case Mode::servo:
            stream_over = takeServo(sent, answer, step);
            break;
    }
    judge();
    core_.publish(state_);
    if (motion_over) {  // only now, so that an observer of the end sees the states that go with it
        slot_.end(planned_.end());
    }
    if (stream_over) {
        core_.end(*stream_over);
    }
}

void MotionCommander::note(const CabinetState& answer, SteadyTime now) noexcept {
    answer_ = answer;
    ++state_.cycle;
    state_.position = answer.position;
    state_.velocity = answer.velocity;
    state_.standstill = stands(answer);
    state_.stamp = now;
    if (mode_ != Mode::servo) {
        hold(answer.position);
    }
}

/// Without a stream the arm is commanded to stand where it was last sent, or else where it is. It
/// may still be on its way there.
void MotionCommander::hold(const device::JointArray& measured) noexcept {
    if (holds_ && !state_.standstill) {
        return;
    }
    holds_ = holds_ && device::largestDifference(measured, state_.commanded_position) < kHeld;
    if (!holds_) {
        state_.commanded_position = measured;
    }
}

/// A refused setting is sent again by the next motion that needs it.
void MotionCommander::takeChore(const Command& sent, const CabinetState& answer) noexcept {
    if (chores_.empty() || sent.code != chores_.front().code) {
        return;
    }
    chores_.drop();
    if (answer.executed) {
        settings_.taken(sent);
    } else {
        settings_.refused(sent);
    }
}

void MotionCommander::missedCycles(std::uint64_t count) noexcept {
    state_.missed_cycles += count;
    skipped_ = static_cast<int>(std::min<std::uint64_t>(count, kMostSkipped));
}

bool MotionCommander::takePlanned(const Command& sent, const CabinetState& answer,
                                  double step) noexcept {
    if (readiness_.notReady()) {
        planned_.stop(RunEnd::Cause::not_ready);
    }
    const bool over = planned_.take(sent, answer, step, settings_);
    const auto& motion = *slot_.posted();
    if (motion.observer) {
        motion.observer->observe(state_);
    }
    if (!over) {
        return false;
    }
    mode_ = Mode::idle;
    if (planned_.end().cause == RunEnd::Cause::at_target && !motion.target_flange) {
        state_.commanded_position = motion.target_joints;
        holds_ = true;
    }
    return true;
}

std::optional<EndCause> MotionCommander::takeServo(const Command& sent, const CabinetState& answer,
                                                   double step) noexcept {
    if (readiness_.notReady()) {
        servo_.stop();
    }
    const auto status = servo_.take(sent, answer, step, settings_);
    state_.commanded_position = servo_.commanded();
    switch (status) {
        case ServoRun::Status::running:
            return std::nullopt;
        case ServoRun::Status::done:
            return endServo(EndCause::done);
        case ServoRun::Status::stopped:
            return endServo(readiness_.notReady() ? EndCause::safety : EndCause::stopped);
        case ServoRun::Status::fault:
            latch(servo_.fault());
            return endServo(EndCause::safety);
    }
    return std::nullopt;
}

EndCause MotionCommander::endServo(EndCause cause) noexcept {
    mode_ = Mode::idle;
    holds_ = cause == EndCause::done;
    hold(answer_.position);
    settings_.require(chooseInterface(Interface::standard), chores_);
    return cause;
}

bool MotionCommander::hurried() const noexcept {
    switch (mode_) {
        case Mode::settling_in:
            return try_again_in_ == 0.0;
        case Mode::idle:
            return !chores_.empty();
        case Mode::planned:
            return planned_.hurried();
        case Mode::servo:
            return servo_.hurried();
    }
    return false;
}

// ---- safety ------------------------------------------------------------------------------------

/// A fault of a stream stays until resetFault().
void MotionCommander::latch(const ServoFault& fault) {
    if (readiness_.notReady()) {
        return;  // which says more
    }
    const bool limit =
        fault.kind != ServoFault::Kind::not_following && fault.kind != ServoFault::Kind::refused;
    latched_.store(true);
    condition_ = Condition::latched;
    core_.setSafety({SafetyState::protective_stop,
                     fmt::format("{}: {}", core_.info().name, toString(fault)), limit});
}

void MotionCommander::judge() {
    const bool stays = condition_ == Condition::wrong_model ||
                       (condition_ == Condition::latched && latched_.load());
    if (mode_ == Mode::settling_in || stays) {
        return;
    }
    if (readiness_.notReady()) {
        change(Condition::not_ready,
               "the cabinet is not ready to move: stopped for safety, drives off or enabling "
               "switch released; see its panel");
    } else if (condition_ != Condition::none) {
        condition_ = Condition::none;
        core_.setSafety({SafetyState::normal, "", false});
    }
}

void MotionCommander::change(Condition condition, std::string text) {
    if (condition == condition_) {
        return;
    }
    condition_ = condition;
    const bool stop = condition == Condition::not_ready;
    core_.setSafety({stop ? SafetyState::protective_stop : SafetyState::fault,
                     core_.info().name + ": " + std::move(text), false});
}

}  // namespace metier::iiwa_driver
