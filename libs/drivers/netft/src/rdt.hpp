#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "metier/base/error.hpp"

namespace metier::netft_driver {

// Requests and records of the sensor's RDT protocol, big-endian over UDP.

enum class RdtCommand : std::uint16_t {
    stop = 0x0000,
    real_time = 0x0002,  ///< one record per datagram, until stopped
    bias = 0x0042,       ///< makes the present load zero
};

/// One request, for records without end.
std::array<std::byte, 8> rdtRequest(RdtCommand command) noexcept;

inline constexpr std::size_t kRecordSize = 36;

/// One record as it comes.
struct RdtRecord {
    std::uint32_t sequence = 0;         ///< counts the records since the last request
    std::uint32_t sensor_sequence = 0;  ///< counts the sensor's own measurements
    std::uint32_t status = 0;
    std::array<std::int32_t, 6> counts{};  ///< force along x, y, z, torque about x, y, z
};

/// \param bytes kRecordSize of them
/// Errors: invalid_argument for any other number.
Result<RdtRecord> parseRecord(std::span<const std::byte> bytes);

/// Reports whether the values with this status word may not be used; a latched monitor condition
/// alone is only a warning.
bool isError(std::uint32_t status) noexcept;

/// The causes in a status word by name, "gauge saturation or A/D error (status 80020000)".
std::string describeStatus(std::uint32_t status);

}  // namespace metier::netft_driver
