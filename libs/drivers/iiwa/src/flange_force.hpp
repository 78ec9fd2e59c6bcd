#pragma once

#include <chrono>
#include <mutex>
#include <string>

#include "metier/device/arm_core.hpp"
#include "metier/device/force_torque_sensor.hpp"
#include "metier/device/shared_value.hpp"
#include "metier/iiwa_driver/wire.hpp"

namespace metier::iiwa_driver {

/// The cabinet's estimate of the wrench on the flange, from the torques of the joints, as a sensor:
/// in the axes of the flange frame, once per cycle.
class FlangeForce final : public device::ForceTorqueSensor {
public:
    /// \param core    of the arm; must outlive this
    /// \param longest silence of the cabinet after which a sample is no longer valid, > 0
    FlangeForce(device::ArmCore& core, std::chrono::nanoseconds longest);

    /// The cycle thread: neither locks nor allocates.
    void take(const CabinetState& answer, SteadyTime now) noexcept;

    const std::string& name() const noexcept override { return name_; }
    device::WrenchSample sample() const noexcept override;
    device::Safety safety() const override { return core_.safety(); }
    Result<void> tare() override;
    device::Registration onSafetyChange(SafetyCallback callback) override {
        return core_.onSafetyChange(std::move(callback));
    }

private:
    device::ArmCore& core_;
    const std::chrono::nanoseconds longest_;
    const std::string name_;
    device::SharedValue<device::WrenchSample> newest_;  ///< as received from the cabinet
    device::SharedValue<device::WrenchSample> zero_;
    std::mutex tare_mutex_;  ///< one writer of zero_
};

}  // namespace metier::iiwa_driver
