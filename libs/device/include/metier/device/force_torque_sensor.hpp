#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <string>

#include "metier/base/clock.hpp"
#include "metier/base/error.hpp"
#include "metier/device/arm.hpp"

namespace metier::device {

/// One measurement. Trivially copyable.
struct WrenchSample {
    std::array<double, 3> force{};                   ///< along x, y, z of the sensor frame [N]
    std::array<double, 3> torque{};                  ///< about x, y, z of the sensor frame [Nm]
    std::uint64_t sequence = 0;                      ///< counter of the sensor's own measurements
    SafetyState health = SafetyState::disconnected;  ///< normal: the values may be used
    SteadyTime stamp{};                              ///< time of arrival
};

/// A force-torque sensor with its own stream of measurements: the interface of every sensor driver.
///
/// Threading: every function from any thread; only tare() waits. sample() neither locks nor
/// allocates, so a cycle thread may call it.
class ForceTorqueSensor {
public:
    using SafetyCallback = std::function<void(const Safety&)>;

    virtual ~ForceTorqueSensor() = default;

    /// Name for messages.
    virtual const std::string& name() const noexcept = 0;
    /// Newest measurement. Its health is not normal once the sensor has been silent for 5 periods.
    virtual WrenchSample sample() const noexcept = 0;
    /// State of the sensor with its reason; normal: its values may be used.
    virtual Safety safety() const = 0;
    /// Takes the present load as zero. Waits for the sensor. Errors: connection_lost, timeout.
    virtual Result<void> tare() = 0;
    /// Calls `callback` on the sensor's notifying thread after each change of that state.
    virtual Registration onSafetyChange(SafetyCallback callback) = 0;
};

}  // namespace metier::device
