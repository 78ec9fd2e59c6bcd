#include "metier/device/arm_core.hpp"

#include <cmath>

namespace metier::device {

ArmCore::ArmCore(ArmInfo info)
    : info_(std::move(info)),
      safety_({SafetyState::disconnected, info_.name + ": not connected yet"}) {
    ArmState state;
    state.position = JointArray(info_.axisCount());
    state.velocity = state.position;
    state.commanded_position = state.position;
    published_.write(state);
}

ArmCore::~ArmCore() {
    if (owner_) {
        owner_->ended(EndCause::disconnected,
                      {SafetyState::disconnected, info_.name + ": the driver was shut down"});
    }
}

Result<void> ArmCore::attach(std::shared_ptr<SetPointSource> source) {
    const std::lock_guard lock(mutex_);
    METIER_TRY(checkNormal(safety()));
    if (owner_) {
        return fail(Errc::resource_unavailable, info_.name + ": another source moves the arm");
    }
    owner_ = std::move(source);
    loss_ = {SafetyState::disconnected, info_.name + ": the connection was lost for a moment"};
    stop_target_.store(nullptr);
    active_.store(owner_.get());
    return {};
}

void ArmCore::stop() noexcept {
    stop_target_.store(active_.load());
}

Registration ArmCore::onSafetyChange(Arm::SafetyCallback callback) {
    return safety_.onChange(std::move(callback));
}

bool ArmCore::stopRequested() noexcept {
    auto* source = active_.load();
    if (source != nullptr && stop_target_.exchange(nullptr) == source) {
        stopping_ = true;
    }
    return stopping_;
}

void ArmCore::publish(ArmState state) noexcept {
    state.safety = safety_.state();
    published_.write(state);
    measure(state.safety == SafetyState::disconnected ? SteadyTime{} : state.stamp);
}

/// A state may be published twice.
void ArmCore::measure(SteadyTime stamp) noexcept {
    if (stamp == last_stamp_) {
        return;
    }
    if (stamp != SteadyTime{} && last_stamp_ != SteadyTime{}) {
        const std::chrono::duration<double> off = stamp - last_stamp_ - info_.cycle;
        jitter_.add(std::abs(off.count()));
    }
    last_stamp_ = stamp;
}

void ArmCore::end(EndCause cause) noexcept {
    if (active_.exchange(nullptr) == nullptr) {
        return;
    }
    stopping_ = false;
    end_cause_.store(cause);
    ended_.store(true);
}

void ArmCore::setSafety(Safety safety) {
    const std::lock_guard lock(mutex_);  // an attach() sees either state, and end() comes after it
    if (safety.state != SafetyState::normal) {
        loss_ = safety;
    }
    safety_.set(std::move(safety));
}

void ArmCore::dispatch() {
    safety_.dispatch();
    tellEnd();
}

void ArmCore::tellEnd() {
    if (!ended_.exchange(false)) {
        return;
    }
    const auto cause = end_cause_.load();
    std::shared_ptr<SetPointSource> source;
    Safety now;
    {
        const std::lock_guard lock(mutex_);
        source = std::move(owner_);
        owner_.reset();
        now = safety();
        const bool lost = cause == EndCause::disconnected || cause == EndCause::safety;
        if (lost && now.state == SafetyState::normal) {
            now = loss_;  // it is over already, but ended the motion
        }
    }
    source->ended(cause, now);
}

}  // namespace metier::device
