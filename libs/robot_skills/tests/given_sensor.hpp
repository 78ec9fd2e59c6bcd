#pragma once

#include <string>
#include <utility>

#include "metier/device/force_torque_sensor.hpp"

namespace metier::robot_skills {

/// A sensor whose measurement is given.
class GivenSensor final : public device::ForceTorqueSensor {
public:
    GivenSensor() { now.health = device::SafetyState::normal; }

    device::WrenchSample now;
    const std::string& name() const noexcept override { return name_; }
    device::WrenchSample sample() const noexcept override { return now; }
    device::Safety safety() const override { return {now.health, text_, false}; }
    Result<void> tare() override { return {}; }
    device::Registration onSafetyChange(SafetyCallback callback) override {
        hear_ = std::move(callback);
        return device::Registration([this] { hear_ = nullptr; });
    }
    /// Changes its state, and says so.
    void become(device::SafetyState health, const std::string& text = "") {
        now.health = health;
        text_ = text;
        if (hear_) {
            hear_(safety());
        }
    }

private:
    const std::string name_ = "netft";
    std::string text_ = "netft: silent";
    SafetyCallback hear_;
};

}  // namespace metier::robot_skills
