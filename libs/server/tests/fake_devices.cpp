#include "fake_devices.hpp"

#include <utility>

namespace metier::device {

Driver simulatorDriver();  // as cmake/MetierDevices.cmake declares it

}  // namespace metier::device

namespace metier::server::testing {
namespace {

// A driver is opened by a plain function: what it was asked for is kept here.
device::OpenRequest last_request;
std::weak_ptr<FakeGripper> last_gripper;

Result<device::OpenDevice> openGripper(const device::OpenRequest& request) {
    last_request = request;
    static_cast<void>(request.settings.numberOr("port", 0, 0, 65'535));
    METIER_TRY(request.settings.finish());
    auto gripper = std::make_shared<FakeGripper>();  // shared, as OpenDevice asks for
    last_gripper = gripper;
    device::OpenDevice device;
    device.gripper = gripper.get();
    device.owner = std::move(gripper);
    return device;
}

Result<device::OpenDevice> openSensor(const device::OpenRequest& request) {
    METIER_TRY(request.settings.finish());
    auto sensor = std::make_shared<FakeSensor>();
    device::OpenDevice device;
    device.force_torque_sensor = sensor.get();
    device.owner = std::move(sensor);
    return device;
}

}  // namespace

device::GripperState FakeGripper::state() const noexcept {
    const std::lock_guard lock(mutex_);
    return state_;
}

device::Safety FakeGripper::safety() const {
    const std::lock_guard lock(mutex_);
    return {state_.safety, why_, false};
}

Result<void> FakeGripper::grasp(const device::GripperRequest& /*request*/, Done done) {
    return end(0.03, true, std::move(done));
}

Result<void> FakeGripper::release(const device::GripperRequest& /*request*/, Done done) {
    return end(info_.stroke, false, std::move(done));
}

Result<void> FakeGripper::move(const device::GripperRequest& request, Done done) {
    return end(request.width.value_or(0.0), false, std::move(done));
}

Result<void> FakeGripper::end(double width, bool holds, Done done) {
    {
        const std::lock_guard lock(mutex_);
        state_.width = width;
        state_.part_held = holds;
    }
    notifier_ = std::jthread([done = std::move(done), width, holds] {
        done(device::GripperOutcome{.width = width, .part_held = holds});
    });
    return {};
}

device::Registration FakeGripper::onSafetyChange(SafetyCallback callback) {
    const std::lock_guard lock(mutex_);
    const int id = next_++;
    callbacks_[id] = std::move(callback);
    return device::Registration([this, id] {
        const std::lock_guard ending(mutex_);
        callbacks_.erase(id);
    });
}

bool FakeGripper::isWatched() const {
    const std::lock_guard lock(mutex_);
    return !callbacks_.empty();
}

void FakeGripper::become(device::SafetyState safety, const std::string& why) {
    std::map<int, SafetyCallback> callbacks;
    {
        const std::lock_guard lock(mutex_);
        state_.safety = safety;
        why_ = why;
        callbacks = callbacks_;
    }
    for (const auto& [id, callback] : callbacks) {
        callback({safety, why, false});
    }
}

std::vector<device::Driver> fakeDrivers() {
    return {device::simulatorDriver(),
            {"gripper", "a fake", openGripper},
            {"locked", "a fake that has a port", openGripper, {"port", 7000}},
            {"sensor", "a fake", openSensor}};
}

const device::OpenRequest& lastRequest() {
    return last_request;
}

std::shared_ptr<FakeGripper> lastGripper() {
    return last_gripper.lock();
}

}  // namespace metier::server::testing
