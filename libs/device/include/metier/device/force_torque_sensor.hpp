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
    /// Force along x, y, z of the sensor frame [N].
    std::array<double, 3> force{};
    /// Torque about x, y, z of the sensor frame [N m].
    std::array<double, 3> torque{};
    /// Counter of the sensor's own measurements; a step over 1 shows lost ones.
    std::uint64_t sequence = 0;
    /// State of the sensor; normal: the values may be used.
    SafetyState health = SafetyState::disconnected;
    /// Time of arrival on this machine's monotonic clock.
    SteadyTime stamp{};
};

/// A force-torque sensor with its own stream of measurements: the interface of every sensor driver.
///
/// Threading: every function from any thread; only tare() waits. sample() neither locks nor
/// allocates, so a cycle thread may call it.
class ForceTorqueSensor {
public:
    /// Callback for a change of the sensor's state; may lock, should not wait.
    using SafetyCallback = std::function<void(const Safety&)>;

    virtual ~ForceTorqueSensor() = default;

    /// Name for messages; valid as long as the sensor.
    virtual const std::string& name() const noexcept = 0;
    /// Newest measurement. Its health is not normal once the sensor has been silent for 5 periods.
    virtual WrenchSample sample() const noexcept = 0;
    /// State of the sensor with its reason; normal: its values may be used.
    virtual Safety safety() const = 0;
    /// Takes the present load as zero. Waits for the sensor, about 1 s at most: not for a server's
    /// thread.
    /// Errors: connection_lost, device_fault (the sensor's state is not normal), timeout (no
    ///         sensor's answer, or a load that is not zero afterwards).
    virtual Result<void> tare() = 0;
    /// Calls `callback` on the sensor's notifying thread after each change of that state.
    virtual Registration onSafetyChange(SafetyCallback callback) = 0;
};

}  // namespace metier::device
