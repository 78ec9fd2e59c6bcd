#include "metier/client/remote_arm.hpp"

#include <utility>

#include "remote_arm/worker.hpp"

namespace metier::client {

Result<std::unique_ptr<RemoteArm>> RemoteArm::connect(RemoteArmOptions options) {
    // Shared by the thread that waits and the sessions that ring, also late.
    auto wake_up = std::make_shared<WakeUp>();
    METIER_ASSIGN(auto session, StreamSession::open(options, wake_up));
    auto worker =
        std::make_unique<Worker>(std::move(options), std::move(wake_up), std::move(session));
    return std::unique_ptr<RemoteArm>(new RemoteArm(std::move(worker)));
}

RemoteArm::RemoteArm(std::unique_ptr<Worker> worker) : worker_(std::move(worker)) {}
RemoteArm::~RemoteArm() = default;

const opcua_skill::KinematicsData& RemoteArm::kinematics() const noexcept {
    return worker_->kinematics();
}

void RemoteArm::nameOwner(std::string application_uri) {
    worker_->nameOwner(std::move(application_uri));
}

std::optional<RemoteArm::Absence> RemoteArm::absence() const {
    return worker_->absence();
}

const device::ArmInfo& RemoteArm::info() const noexcept {
    return worker_->info();
}
device::ArmState RemoteArm::state() const noexcept {
    return worker_->state();
}
device::Safety RemoteArm::safety() const {
    return worker_->safety();
}

Result<void> RemoteArm::attach(std::shared_ptr<device::SetPointSource> source) {
    return worker_->attach(std::move(source));
}

void RemoteArm::stop() noexcept {
    worker_->stop();
}
Result<void> RemoteArm::resetFault() {
    return worker_->resetFault();
}

device::Registration RemoteArm::onSafetyChange(SafetyCallback callback) {
    return worker_->onSafetyChange(std::move(callback));
}

}  // namespace metier::client
