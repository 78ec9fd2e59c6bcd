#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

/// Raw Data Transfer (RDT) of an ATI Net F/T: datagrams with big-endian numbers.
namespace metier::virtual_netft {

enum class Command : std::uint16_t {
    stop = 0x0000,
    start_real_time = 0x0002,   ///< one record per datagram
    start_buffered = 0x0003,    ///< several records per datagram
    start_multi_unit = 0x0004,  ///< one, in step with other sensors; alone as in real time
    reset_latch = 0x0041,       ///< resets the latch of the monitor condition
    set_bias = 0x0042,
};

struct Request {
    Command command = Command::stop;
    std::uint32_t sample_count = 0;  ///< 0: without end
};

/// Parses a request; nothing if the datagram is no request, which the sensor ignores.
std::optional<Request> parseRequest(std::span<const std::byte> datagram) noexcept;

struct Record {
    std::uint32_t rdt_sequence = 0;  ///< number of the record since the request
    std::uint32_t ft_sequence = 0;   ///< number of the sensor's own sample
    std::uint32_t status = 0;
    std::array<std::int32_t, 6> counts{};  ///< force x, y, z, torque x, y, z
};

/// Appends the 36 bytes of a record.
void append(std::vector<std::byte>& datagram, const Record& record);

/// Status words.
namespace status {
inline constexpr std::uint32_t kHealthy = 0;
inline constexpr std::uint32_t kMonitorLatched = 0x80010000;  ///< a warning: data stay valid
inline constexpr std::uint32_t kSaturated = 0x80020000;
inline constexpr std::uint32_t kTemperature = 0x80000004;
}  // namespace status

}  // namespace metier::virtual_netft
