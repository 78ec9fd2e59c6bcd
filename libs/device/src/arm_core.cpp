#include "metier/device/arm_core.hpp"

#include <fmt/format.h>

namespace metier::device {

ArmCore::ArmCore(ArmInfo info) : info_(std::move(info)) {
    known_.text = info_.name + ": not connected yet";
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

Safety ArmCore::safety() const {
    const std::lock_guard lock(mutex_);
    return known_;
}

Result<void> ArmCore::attach(std::shared_ptr<SetPointSource> source) {
    const std::lock_guard lock(mutex_);
    if (known_.state != SafetyState::normal) {
        return fail(Errc::device_fault,
                    fmt::format("{} ({})", known_.text, toString(known_.state)));
    }
    if (owner_) {
        return fail(Errc::resource_unavailable, info_.name + ": another source moves the arm");
    }
    owner_ = std::move(source);
    stop_target_.store(nullptr);
    active_.store(owner_.get());
    return {};
}

void ArmCore::stop() noexcept {
    stop_target_.store(active_.load());
}

Registration ArmCore::onSafetyChange(Arm::SafetyCallback callback) {
    const std::lock_guard lock(mutex_);
    const auto id = next_callback_++;
    callbacks_.emplace_back(id, std::move(callback));
    return Registration([this, id] {
        const std::lock_guard inner(mutex_);
        std::erase_if(callbacks_, [id](const auto& entry) { return entry.first == id; });
    });
}

bool ArmCore::stopRequested() noexcept {
    auto* source = active_.load();
    if (source != nullptr && stop_target_.exchange(nullptr) == source) {
        stopping_ = true;
    }
    return stopping_;
}

void ArmCore::publish(ArmState state) noexcept {
    state.safety = safety_.load();
    published_.write(state);
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
    const std::lock_guard lock(mutex_);
    if (safety.state != known_.state) {
        safety_changed_.store(true);
    }
    safety_.store(safety.state);
    known_ = std::move(safety);
}

void ArmCore::dispatch() {
    tellSafety();
    tellEnd();
}

void ArmCore::tellSafety() {
    if (!safety_changed_.exchange(false)) {
        return;
    }
    std::vector<Arm::SafetyCallback> callbacks;
    Safety now;
    {
        const std::lock_guard lock(mutex_);
        if (known_.state == told_) {
            return;
        }
        now = known_;
        told_ = now.state;
        for (const auto& [id, callback] : callbacks_) {
            callbacks.push_back(callback);
        }
    }
    for (const auto& callback : callbacks) {
        callback(now);
    }
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
        now = known_;
    }
    source->ended(cause, now);
}

}  // namespace metier::device
