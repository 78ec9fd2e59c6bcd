#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "calibration.hpp"
#include "metier/device/driver.hpp"
#include "metier/device/force_torque_sensor.hpp"

namespace metier::netft_driver {

/// Options of the driver for one sensor.
struct NetftOptions {
    std::string name;
    std::string host;
    std::uint16_t port = 49152;
    std::uint16_t http_port = 80;
    std::optional<Calibration> calibration{};  ///< not set: the sensor's own, by HTTP
    UnitTexts units{};                         ///< units for a page that does not state them
    /// Records [1/s]. Not set: as the sensor's page says, else kUsualRate.
    std::optional<double> rate{};
    /// Without a record: the sensor is lost. Not set: silenceAt() that rate.
    std::optional<std::chrono::milliseconds> silence{};
};

inline constexpr double kUsualRate = 1000.0;  ///< records [1/s]

/// Five periods of the records, and 20 ms at least: a computer without a real-time kernel delays a
/// thread by as much now and then.
std::chrono::milliseconds silenceAt(double rate);

/// Reads `settings`: port, http_port, rate, silence, counts_per_force and counts_per_torque, or
/// force_unit and torque_unit.
/// Errors: invalid_argument for all that is wrong.
Result<NetftOptions> readOptions(const device::OpenRequest& request);

/// An ATI Net F/T sensor. Connects, and connects again, by itself; each time it reads the
/// calibration anew, and without one it gives no value.
class NetftSensor final : public device::ForceTorqueSensor {
public:
    explicit NetftSensor(NetftOptions options);
    /// Ends the stream.
    ~NetftSensor() override;
    NetftSensor(const NetftSensor&) = delete;
    NetftSensor& operator=(const NetftSensor&) = delete;

    const std::string& name() const noexcept override;
    device::WrenchSample sample() const noexcept override;
    device::Safety safety() const override;
    /// Waits at most 1 s. Errors also: device_fault while the sensor reports an error.
    Result<void> tare() override;
    device::Registration onSafetyChange(SafetyCallback callback) override;

    /// Records that were sent and did not come, since the first connection.
    std::uint64_t lostRecords() const noexcept;

private:
    class Session;

    std::unique_ptr<Session> session_;
};

}  // namespace metier::netft_driver
