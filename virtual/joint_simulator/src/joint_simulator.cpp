#include "metier/joint_simulator/joint_simulator.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

namespace metier::joint_simulator {

using device::EndCause;
using device::SafetyState;

namespace {

// The measured arm has caught up with the commanded one when it is closer than this [rad].
constexpr double kArrived = 1e-4;

Result<void> checkAxis(const AxisLimits& limits, double start, std::size_t axis) {
    const bool positive = limits.velocity > 0.0 && limits.acceleration > 0.0;
    if (!positive || !(limits.lower < limits.upper)) {
        return fail(
            Errc::invalid_argument,
            fmt::format("axis {}: limits {} to {} rad, {} rad/s, {} rad/s2 are no limits", axis + 1,
                        limits.lower, limits.upper, limits.velocity, limits.acceleration));
    }
    if (!(start >= limits.lower && start <= limits.upper)) {
        return fail(Errc::invalid_argument,
                    fmt::format("axis {}: start position {} rad outside {} to {} rad", axis + 1,
                                start, limits.lower, limits.upper));
    }
    return {};
}

Result<void> check(const JointSimulatorOptions& options) {
    const auto axes = options.axis_names.size();
    if (axes == 0 || axes > device::kMaxAxes || options.limits.size() != axes ||
        options.start_position.size() != axes) {
        return fail(
            Errc::invalid_argument,
            fmt::format("{} axis names, {} limits, {} start positions: must be equal, 1 to {}",
                        axes, options.limits.size(), options.start_position.size(),
                        device::kMaxAxes));
    }
    if (options.cycle.count() <= 0 || options.delay_cycles > kMaxDelayCycles) {
        return fail(Errc::invalid_argument,
                    fmt::format("cycle {} ns must be over 0, delay {} cycles at most {}",
                                options.cycle.count(), options.delay_cycles, kMaxDelayCycles));
    }
    for (std::size_t axis = 0; axis < axes; ++axis) {
        METIER_TRY(checkAxis(options.limits[axis], options.start_position[axis], axis));
    }
    return {};
}

}  // namespace

Result<std::unique_ptr<JointSimulator>> JointSimulator::create(JointSimulatorOptions options) {
    METIER_TRY(check(options));
    return std::unique_ptr<JointSimulator>(new JointSimulator(std::move(options)));
}

JointSimulator::JointSimulator(JointSimulatorOptions options)
    : info_{std::move(options.name), std::move(options.axis_names), options.cycle},
      standstill_speed_(options.standstill_speed),
      guard_(std::move(options.limits), options.tolerance, info_.cycleSeconds()),
      lag_(options.delay_cycles, options.time_constant, info_.cycleSeconds()) {
    const device::JointArray start{std::span<const double>(options.start_position)};
    guard_.reset(start);
    lag_.reset(start);
    state_.safety = SafetyState::normal;
    state_.position = start;
    state_.commanded_position = start;
    state_.velocity = device::JointArray(start.size());
    published_.write(state_);
}

JointSimulator::~JointSimulator() {
    if (owner_) {
        owner_->ended(EndCause::disconnected,
                      {SafetyState::disconnected, info_.name + ": the simulator was shut down"});
    }
}

// ---- control side ------------------------------------------------------------------------------

device::Safety JointSimulator::safety() const {
    const auto state = safety_.load();
    if (state == SafetyState::normal) {
        return {};
    }
    const auto reason = reason_.read();
    switch (reason.cause) {
        case Cause::violation:
            return {state, info_.name + ": " + toText(reason.violation), true};
        case Cause::external: {
            const std::lock_guard lock(mutex_);
            return {state, info_.name + ": " + external_text_};
        }
        case Cause::emergency:
            return {state, info_.name + ": emergency stop pressed"};
        case Cause::disconnected:
            return {state, info_.name + ": no connection to the controller"};
        case Cause::none:
            break;
    }
    return {state, info_.name + ": " + std::string(device::toString(state))};
}

Result<void> JointSimulator::attach(std::shared_ptr<device::SetPointSource> source) {
    METIER_TRY(device::checkNormal(safety()));
    const std::lock_guard lock(mutex_);
    if (owner_) {
        return fail(Errc::resource_unavailable, info_.name + ": another source moves the arm");
    }
    owner_ = std::move(source);
    stop_target_.store(nullptr);
    active_.store(owner_.get());
    return {};
}

void JointSimulator::stop() noexcept {
    stop_target_.store(active_.load());
}

Result<void> JointSimulator::resetFault() {
    auto state = safety_.load();
    if (state == SafetyState::normal) {
        return {};
    }
    if (state == SafetyState::disconnected) {
        return fail(Errc::connection_lost, safety().text);
    }
    if (emergency_pressed_.load()) {
        return fail(Errc::device_fault, info_.name + ": the emergency stop is still pressed");
    }
    if (!standing_.load()) {
        return fail(Errc::device_fault, info_.name + ": the arm still brakes");
    }
    safety_.compare_exchange_strong(state, SafetyState::normal);
    return {};
}

void JointSimulator::protectiveStop(std::string text) {
    {
        const std::lock_guard lock(mutex_);
        external_text_ = std::move(text);
    }
    protective_requested_.store(true);
}

void JointSimulator::emergencyStop(EmergencyStop button) noexcept {
    emergency_pressed_.store(button == EmergencyStop::pressed);
}

void JointSimulator::disconnect() noexcept {
    link_cut_.store(true);
}

void JointSimulator::reconnect() noexcept {
    link_cut_.store(false);
}

void JointSimulator::moveByHand(const device::JointArray& position) noexcept {
    hand_move_.write(position);
}

void JointSimulator::dispatch() {
    reported_.set(safety());
    reported_.dispatch();
    tellEnd();
}

void JointSimulator::tellEnd() {
    if (!ended_.exchange(false)) {
        return;
    }
    const auto cause = end_cause_.load();
    std::shared_ptr<device::SetPointSource> source;
    {
        const std::lock_guard lock(mutex_);
        source = std::move(owner_);
        owner_.reset();
    }
    source->ended(cause, safety());
}

void JointSimulator::step() {
    ++steps_;
    if (cycle(SteadyTime(info_.cycle * steps_), 0)) {
        dispatch();
    }
}

// ---- cycle thread ------------------------------------------------------------------------------

bool JointSimulator::cycle(SteadyTime scheduled, std::uint64_t missed) noexcept {
    ++state_.cycle;
    takeRequests();
    move();
    lag_.advance(guard_.position());
    publish(scheduled, missed);
    endWhenDue();
    const bool changed = state_.safety != last_safety_;
    last_safety_ = state_.safety;
    return changed || ended_.load();
}

void JointSimulator::takeRequests() noexcept {
    if (protective_requested_.exchange(false) && safety_.load() == SafetyState::normal) {
        enter(SafetyState::protective_stop, {Cause::external, {}});
    }
    const auto safety = safety_.load();
    if (emergency_pressed_.load() && safety != SafetyState::emergency_stop &&
        safety != SafetyState::disconnected) {
        enter(SafetyState::emergency_stop, {Cause::emergency, {}});
    }
    if (link_cut_.load() && safety != SafetyState::disconnected) {
        enter(SafetyState::disconnected, {Cause::disconnected, {}});
    }
    if (!link_cut_.load() && safety == SafetyState::disconnected) {
        enter(SafetyState::normal, {});
    }
    takeHandMove();
}

void JointSimulator::takeHandMove() noexcept {
    if (!hand_move_.hasNew()) {
        return;
    }
    const auto& position = hand_move_.read();
    if (active_.load() == nullptr && guard_.standing() && position.size() == info_.axisCount()) {
        guard_.reset(position);
        lag_.reset(position);
    }
}

void JointSimulator::enter(SafetyState safety, const StopReason& reason) noexcept {
    reason_.write(reason);
    standing_.store(false);
    safety_.store(safety);
}

void JointSimulator::move() noexcept {
    auto* source = active_.load();
    if (source != nullptr && stop_target_.exchange(nullptr) == source) {
        stopping_ = true;
    }
    if (safety_.load() != SafetyState::normal || stopping_) {
        guard_.brake();
    } else if (source != nullptr) {
        follow(*source);
    } else {
        judge(guard_.position());
    }
}

void JointSimulator::follow(device::SetPointSource& source) noexcept {
    auto set_point = guard_.position();
    const auto next = source.next(state_, set_point);
    if (next == device::SetPointSource::Next::done) {
        set_point = guard_.position();
        end(EndCause::done);
    }
    judge(set_point);
}

void JointSimulator::judge(const device::JointArray& set_point) noexcept {
    if (const auto violation = guard_.accept(set_point)) {
        enter(SafetyState::protective_stop, {Cause::violation, *violation});
        guard_.brake();
    }
}

bool JointSimulator::measuredStands() const noexcept {
    const auto& velocity = lag_.velocity();
    return std::all_of(velocity.begin(), velocity.end(),
                       [this](double v) { return std::abs(v) < standstill_speed_; });
}

bool JointSimulator::cameToRest() const noexcept {
    return guard_.standing() && measuredStands() &&
           device::largestDifference(guard_.position(), lag_.position()) < kArrived;
}

void JointSimulator::publish(SteadyTime scheduled, std::uint64_t missed) noexcept {
    state_.safety = safety_.load();
    if (state_.safety != SafetyState::disconnected) {
        state_.position = lag_.position();
        state_.velocity = lag_.velocity();
        state_.commanded_position = guard_.position();
        state_.standstill = measuredStands();
        state_.missed_cycles = missed;
        state_.stamp = scheduled;
    }
    published_.write(state_);
    standing_.store(cameToRest());
}

void JointSimulator::endWhenDue() noexcept {
    if (active_.load() == nullptr) {
        return;
    }
    if (state_.safety == SafetyState::disconnected) {
        end(EndCause::disconnected);
        return;
    }
    const bool standing = cameToRest();
    if (state_.safety != SafetyState::normal && standing) {
        end(EndCause::safety);
    } else if (stopping_ && standing) {
        end(EndCause::stopped);
    }
}

void JointSimulator::end(EndCause cause) noexcept {
    stopping_ = false;
    active_.store(nullptr);
    end_cause_.store(cause);
    ended_.store(true);
}

}  // namespace metier::joint_simulator
