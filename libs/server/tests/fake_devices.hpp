#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "metier/device/driver.hpp"
#include "metier/device/force_torque_sensor.hpp"
#include "metier/device/gripper.hpp"

namespace metier::server::testing {

/// A gripper that carries out each motion at once, and says so on a thread of its own.
class FakeGripper final : public device::Gripper {
public:
    const device::GripperInfo& info() const noexcept override { return info_; }
    device::GripperState state() const noexcept override;
    device::Safety safety() const override;
    Result<void> grasp(const device::GripperRequest& request, Done done) override;
    Result<void> release(const device::GripperRequest& request, Done done) override;
    Result<void> move(const device::GripperRequest& request, Done done) override;
    void stop() noexcept override {}
    Result<void> resetFault() override { return {}; }
    device::Registration onSafetyChange(SafetyCallback callback) override;

    /// Whether there is a listener for changes of the safety state.
    bool isWatched() const;
    /// Changes the safety state, and says so.
    void become(device::SafetyState safety, const std::string& why = "");

private:
    Result<void> end(double width, bool holds, Done done);

    const device::GripperInfo info_{
        .name = "fake", .stroke = 0.11, .min_force = 5, .max_force = 80, .max_speed = 0.42};
    mutable std::mutex mutex_;
    device::GripperState state_{.safety = device::SafetyState::normal};
    std::string why_;
    std::map<int, SafetyCallback> callbacks_;
    int next_ = 0;
    std::jthread notifier_;
};

/// A sensor that always measures the same.
class FakeSensor final : public device::ForceTorqueSensor {
public:
    const std::string& name() const noexcept override { return name_; }
    device::WrenchSample sample() const noexcept override {
        return {.force = {1, 2, 3}, .torque = {4, 5, 6}, .health = device::SafetyState::normal};
    }
    device::Safety safety() const override { return {}; }
    Result<void> tare() override { return {}; }
    device::Registration onSafetyChange(SafetyCallback /*callback*/) override { return {}; }

private:
    const std::string name_ = "fake sensor";
};

/// The simulator of arms; "gripper" and "sensor", which are fakes; "locked", a gripper that one
/// process has at a time, by its setting "port".
std::vector<device::Driver> fakeDrivers();

/// Last request to the driver "gripper" or "locked".
const device::OpenRequest& lastRequest();
/// The gripper that it opened, as long as it is in use.
std::shared_ptr<FakeGripper> lastGripper();

}  // namespace metier::server::testing
