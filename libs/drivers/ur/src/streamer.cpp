#include "streamer.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <span>

namespace metier::ur_driver {

using device::EndCause;
using device::SafetyState;

namespace {

constexpr std::uint32_t kPrimingCycles = 3;  // cycles until registers are surely in force
constexpr std::uint32_t kStandCycles = 3;    // one quiet measurement is no standstill
constexpr std::uint32_t kSlowCycles = 5;     // the scaling may dip while a program starts
constexpr std::uint32_t kAstrayCycles = 5;
constexpr double kSlowStart = 0.5;     // longest time with a reduced scaling at the start [s]
constexpr double kStopPatience = 1.0;  // longest time until the script obeys [s]
constexpr double kFollowMargin = 0.2;  // added to three times the lookahead [s]

std::uint32_t cyclesIn(std::chrono::nanoseconds time, std::chrono::nanoseconds cycle) {
    return static_cast<std::uint32_t>(std::max<std::int64_t>(1, time / cycle));
}

double scaling(const ControllerState& now) noexcept {
    return std::min(now.speed_scaling, 1.0) * std::min(now.target_speed_fraction, 1.0);
}

/// Number of set-points from `older` to `newer`, also across an overflow.
std::int32_t later(std::int32_t newer, std::int32_t older) noexcept {
    return static_cast<std::int32_t>(static_cast<std::uint32_t>(newer) -
                                     static_cast<std::uint32_t>(older));
}

std::int32_t next(std::int32_t number) noexcept {
    const auto following = static_cast<std::int32_t>(static_cast<std::uint32_t>(number) + 1U);
    return following == 0 ? 1 : following;
}

std::string runtimeText(RuntimeState state) {
    return "the controller's program is " + toText(state);
}

}  // namespace

std::string toText(const StreamFault& fault) {
    using Kind = StreamFault::Kind;
    switch (fault.kind) {
        case Kind::not_finite:
            return fmt::format("axis {}: the set-point is not a number", fault.axis + 1);
        case Kind::slowed:
            return fmt::format(
                "the controller runs at {:.0f} % of the speed: put its speed slider to 100 %",
                100.0 * fault.value);
        case Kind::program_ended:
            return runtimeText(fault.runtime_state) +
                   ": someone stopped it, or an error of the controller did";
        case Kind::not_taken:
            return fmt::format("the script on the controller took no set-point for {:.3f} s",
                               fault.value);
        case Kind::not_followed:
            return fmt::format(
                "axis {}: the controller goes to {:.4f} rad, the set-points are {:.4f} to {:.4f} "
                "rad",
                fault.axis + 1, fault.value, fault.low, fault.high);
        case Kind::not_started:
            return fmt::format("the script did not start within {:.1f} s: {}", fault.value,
                               runtimeText(fault.runtime_state));
        case Kind::none:
            break;
    }
    return {};
}

Streamer::Streamer(device::ArmCore& core, const UrSettings& settings, const Joints& max_velocity,
                   std::int32_t first_token)
    : core_(core),
      settings_(settings),
      max_velocity_(max_velocity),
      cycle_(std::chrono::duration<double>(settings.cycle()).count()),
      window_(std::min<std::size_t>(
          kHistory, cyclesIn(std::chrono::nanoseconds(static_cast<std::int64_t>(
                                 1e9 * (3.0 * settings.servoj_lookahead + kFollowMargin))),
                             settings.cycle()))),
      patience_(cyclesIn(settings.receive_timeout, settings.cycle())),
      start_timeout_(cyclesIn(settings.start_timeout, settings.cycle())),
      pace_(settings.cycle()),
      token_(first_token) {
    state_.position = device::JointArray(kAxes);
    state_.velocity = state_.position;
    state_.commanded_position = state_.position;
}

Streamer::Output Streamer::cycle(const ControllerState& now, SteadyTime stamp) noexcept {
    Output out;
    measure(now, stamp);
    const bool stop = core_.stopRequested();
    const bool normal = core_.safetyState() == SafetyState::normal;
    const bool was_ending = phase_ == Phase::ending || phase_ == Phase::idle;
    if (phase_ == Phase::idle && core_.active() != nullptr && normal && !stop) {
        begin();
    } else if (phase_ != Phase::idle && phase_ != Phase::ending && (stop || !normal)) {
        brake();
    }
    advance(now, out);
    if (phase_ != Phase::running) {
        state_.commanded_position = device::JointArray(std::span<const double>(now.target_q));
    }
    core_.publish(state_);
    if (done_) {
        done_ = false;
        core_.end(EndCause::done);
    } else if ((stop || !normal) && was_ending && phase_ == Phase::idle && standing()) {
        core_.end(normal ? EndCause::stopped : EndCause::safety);
    }
    busy_.store(phase_ != Phase::idle);
    return out;
}

void Streamer::disconnected() noexcept {
    enter(Phase::idle);
    busy_.store(false);
    last_timestamp_ = -1.0;
    core_.publish(state_);
    core_.end(EndCause::disconnected);
}

void Streamer::measure(const ControllerState& now, SteadyTime stamp) noexcept {
    const double periods = (now.timestamp - last_timestamp_) / cycle_;
    const bool late = last_timestamp_ >= 0.0 && periods > 1.5 && periods < 1e6;
    const auto passed = late ? static_cast<std::uint64_t>(std::lround(periods)) : 1U;
    last_timestamp_ = now.timestamp;
    state_.cycle += passed;
    state_.missed_cycles += passed - 1;
    state_.position = device::JointArray(std::span<const double>(now.actual_q));
    state_.velocity = device::JointArray(std::span<const double>(now.actual_qd));
    state_.safety = core_.safetyState();
    state_.standstill = std::all_of(now.actual_qd.begin(), now.actual_qd.end(), [this](double v) {
        return std::abs(v) < settings_.standstill_speed;
    });
    state_.stamp = stamp;
    stand_cycles_ = state_.standstill ? stand_cycles_ + 1 : 0;
    cycles_since_violation_ = std::min(cycles_since_violation_ + 1, kViolationMemory);
}

void Streamer::begin() noexcept {
    token_.store(next(token_.load()));
    setpoint_.token = token_.load();
    setpoint_.counter = next(setpoint_.counter);
    first_counter_ = setpoint_.counter;
    history_size_ = 0;
    slow_cycles_ = 0;
    astray_cycles_ = 0;
    enter(Phase::priming);
}

void Streamer::advance(const ControllerState& now, Output& out) noexcept {
    ++phase_cycles_;
    switch (phase_) {
        case Phase::idle:
            return;
        case Phase::priming:
            prime(now, out);
            break;
        case Phase::starting:
            awaitScript(now, out);
            break;
        case Phase::running:
            follow(now, out);
            break;
        case Phase::ending:
            finish(now, out);
            break;
    }
    setpoint_.counter = next(setpoint_.counter);
    out.write = true;
    out.setpoint = setpoint_;
}

void Streamer::prime(const ControllerState& now, Output& out) noexcept {
    setpoint_.position = now.target_q;
    if (phase_cycles_ >= kPrimingCycles) {
        out.upload = setpoint_.token;
        enter(Phase::starting);
    }
}

void Streamer::awaitScript(const ControllerState& now, Output& out) noexcept {
    if (refused_token_.load() == setpoint_.token) {
        brake();
        return;
    }
    setpoint_.position = now.target_q;
    const bool ours = now.script_token == setpoint_.token &&
                      later(now.script_counter, first_counter_) >= 0 &&
                      later(setpoint_.counter, now.script_counter) >= 0 &&
                      now.runtime_state == RuntimeState::playing;
    const bool slowed = scaling(now) < kFullSpeed;
    slow_cycles_ = ours && slowed ? slow_cycles_ + 1 : 0;
    if (ours && !slowed) {
        remember(setpoint_.position);
        enter(Phase::running);
        follow(now, out);
    } else if (seconds(slow_cycles_) > kSlowStart) {
        fail({StreamFault::Kind::slowed, 0, scaling(now)}, out);
    } else if (phase_cycles_ > start_timeout_) {
        StreamFault fault{StreamFault::Kind::not_started, 0, seconds(phase_cycles_)};
        fault.runtime_state = now.runtime_state;
        fail(fault, out);
    }
}

void Streamer::follow(const ControllerState& now, Output& out) noexcept {
    if (const auto fault = findFault(now); fault.kind != StreamFault::Kind::none) {
        fail(fault, out);
        return;
    }
    state_.commanded_position = device::JointArray(std::span<const double>(setpoint_.position));
    if (core_.active() != nullptr && pace_.due(state_.stamp)) {
        ask(out);
    }
    remember(setpoint_.position);
}

void Streamer::ask(Output& out) noexcept {
    auto set_point = state_.commanded_position;
    if (core_.active()->next(state_, set_point) == device::SetPointSource::Next::done) {
        done_ = true;
        return;
    }
    for (std::size_t axis = 0; axis < kAxes; ++axis) {
        if (set_point.size() != kAxes || !std::isfinite(set_point[axis])) {
            fail({StreamFault::Kind::not_finite, axis}, out);
            return;
        }
    }
    take(set_point);
}

void Streamer::take(const device::JointArray& set_point) noexcept {
    for (std::size_t axis = 0; axis < kAxes; ++axis) {
        const double limit = max_velocity_[axis];
        const double speed = std::abs(set_point[axis] - setpoint_.position[axis]) / cycle_;
        if (limit > 0.0 && speed > limit) {
            cycles_since_violation_ = 0;
        }
        setpoint_.position[axis] = set_point[axis];
    }
    state_.commanded_position = set_point;
}

StreamFault Streamer::findFault(const ControllerState& now) noexcept {
    if (now.runtime_state != RuntimeState::playing || now.script_token != setpoint_.token) {
        StreamFault fault{StreamFault::Kind::program_ended};
        fault.runtime_state = now.runtime_state;
        return fault;
    }
    slow_cycles_ = scaling(now) < kFullSpeed ? slow_cycles_ + 1 : 0;
    // Nothing is slowed while the arm only holds its position.
    if (slow_cycles_ >= kSlowCycles && core_.active() != nullptr) {
        return {StreamFault::Kind::slowed, 0, scaling(now)};
    }
    const auto behind = later(setpoint_.counter, now.script_counter);
    if (behind < 0 || behind > static_cast<std::int32_t>(patience_ + kPrimingCycles)) {
        return {StreamFault::Kind::not_taken, 0,
                seconds(static_cast<std::uint32_t>(std::max(behind, 0)))};
    }
    return findDeviation(now);
}

StreamFault Streamer::findDeviation(const ControllerState& now) noexcept {
    StreamFault fault;
    for (std::size_t axis = 0; axis < kAxes; ++axis) {
        double low = setpoint_.position[axis];
        double high = low;
        for (std::size_t i = 0; i < history_size_; ++i) {
            low = std::min(low, history_[i][axis]);
            high = std::max(high, history_[i][axis]);
        }
        const double target = now.target_q[axis];
        if (target < low - settings_.follow_tolerance ||
            target > high + settings_.follow_tolerance) {
            fault = {StreamFault::Kind::not_followed, axis, target, low, high};
        }
    }
    astray_cycles_ = fault.kind == StreamFault::Kind::none ? 0 : astray_cycles_ + 1;
    return astray_cycles_ >= kAstrayCycles ? fault : StreamFault{};
}

void Streamer::fail(const StreamFault& fault, Output& out) noexcept {
    if (core_.active() != nullptr) {
        out.fault = fault;
    }
    brake();
}

void Streamer::finish(const ControllerState& now, Output& out) noexcept {
    const bool running =
        now.runtime_state == RuntimeState::playing || now.runtime_state == RuntimeState::stopping;
    const bool overdue = seconds(phase_cycles_) >= kStopPatience;
    if (running && overdue && !stop_asked_ && now.script_token == token_.load()) {
        stop_asked_ = true;
        out.stop_program = true;
    }
    if (standing() && (!running || overdue)) {
        enter(Phase::idle);
    }
}

void Streamer::brake() noexcept {
    setpoint_.token = 0;
    stop_asked_ = false;
    enter(Phase::ending);
}

void Streamer::enter(Phase phase) noexcept {
    phase_ = phase;
    phase_cycles_ = 0;
}

void Streamer::remember(const Joints& position) noexcept {
    history_[history_next_ % window_] = position;
    history_next_ = (history_next_ + 1) % window_;
    history_size_ = std::min(history_size_ + 1, window_);
}

bool Streamer::standing() const noexcept {
    return stand_cycles_ >= kStandCycles;
}

double Streamer::seconds(std::uint32_t cycles) const noexcept {
    return cycles * cycle_;
}

}  // namespace metier::ur_driver
