#include "wsg50_gripper.hpp"

#include <utility>

#include "session.hpp"

namespace metier::wsg50_driver {

Wsg50Gripper::Wsg50Gripper(Wsg50Options options)
    : session_(std::make_unique<Session>(std::move(options))) {}

Wsg50Gripper::~Wsg50Gripper() = default;

const device::GripperInfo& Wsg50Gripper::info() const noexcept {
    return session_->info();
}

device::GripperState Wsg50Gripper::state() const noexcept {
    return session_->state();
}

device::Safety Wsg50Gripper::safety() const {
    return session_->safety();
}

Result<void> Wsg50Gripper::grasp(const device::GripperRequest& request, Done done) {
    return session_->ask(MotionKind::grasp, request, std::move(done));
}

Result<void> Wsg50Gripper::release(const device::GripperRequest& request, Done done) {
    return session_->ask(MotionKind::release, request, std::move(done));
}

Result<void> Wsg50Gripper::move(const device::GripperRequest& request, Done done) {
    return session_->ask(MotionKind::move, request, std::move(done));
}

void Wsg50Gripper::stop() noexcept {
    session_->stop();
}

Result<void> Wsg50Gripper::resetFault() {
    return session_->resetFault();
}

device::Registration Wsg50Gripper::onSafetyChange(SafetyCallback callback) {
    return session_->onSafetyChange(std::move(callback));
}

}  // namespace metier::wsg50_driver
