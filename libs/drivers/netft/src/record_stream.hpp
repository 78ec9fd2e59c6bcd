#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "calibration.hpp"
#include "metier/device/force_torque_sensor.hpp"
#include "rdt.hpp"

namespace metier::netft_driver {

/// Reads the datagrams of one stream of measurements.
///
/// Taking a datagram that is one does not allocate. Threading: one thread.
class RecordStream {
public:
    explicit RecordStream(const Calibration& calibration) : calibration_(calibration) {}

    /// Takes a datagram of one or more records. \return its newest measurement; nothing if it has
    /// no record that is newer than those before. Its health is normal or fault.
    std::optional<device::WrenchSample> take(std::span<const std::byte> datagram, SteadyTime now);

    /// Status word of the newest record.
    std::uint32_t status() const noexcept { return status_; }

private:
    /// Reports whether the record is newer than those before.
    bool isNew(const RdtRecord& record);
    device::WrenchSample toSample(const RdtRecord& record, SteadyTime now) const noexcept;

    Calibration calibration_;
    std::optional<RdtRecord> last_;
    std::uint64_t sensor_sequence_ = 0;  // the sensor's counter, continued beyond its overflow
    std::uint32_t status_ = 0;
};

}  // namespace metier::netft_driver
