#include "rdt.hpp"

#include <fmt/format.h>

#include <string_view>

namespace metier::netft_driver {
namespace {

constexpr std::uint16_t kRequestHeader = 0x1234;
constexpr std::uint32_t kSummary = 0x80000000U;
constexpr std::uint32_t kMonitorLatched = 0x00010000U;

struct Cause {
    std::uint32_t mask;
    std::string_view name;
};

constexpr std::array kCauses{
    Cause{0x40000000U, "CPU or RAM"},
    Cause{0x20000000U, "digital board"},
    Cause{0x10000000U, "analog board"},
    Cause{0x08000000U, "serial link"},
    Cause{0x04000000U, "program memory"},
    Cause{0x02000000U, "halted by configuration"},
    Cause{0x01000000U, "settings validation"},
    Cause{0x00800000U, "configuration does not fit calibration"},
    Cause{0x00400000U, "network"},
    Cause{0x00200000U, "CAN"},
    Cause{0x00100000U, "RDT"},
    Cause{0x00080000U, "EtherNet/IP"},
    Cause{0x00040000U, "DeviceNet"},
    Cause{0x00020000U, "gauge saturation or A/D error"},
    Cause{kMonitorLatched, "monitor condition latched"},
    Cause{0x00004000U, "watchdog timeout"},
    Cause{0x00002000U, "stack check"},
    Cause{0x00001000U, "EEPROM bus"},
    Cause{0x00000800U, "flash bus"},
    Cause{0x00000400U, "analog board watchdog"},
    Cause{0x00000200U, "gauge excitation too high"},
    Cause{0x00000100U, "gauge excitation too low"},
    Cause{0x00000080U, "analog ground out of range"},
    Cause{0x00000040U, "analog supply too high"},
    Cause{0x00000020U, "analog supply too low"},
    Cause{0x00000010U, "serial link data missing"},
    Cause{0x00000008U, "reference voltage or power"},
    Cause{0x00000004U, "temperature"},
    Cause{0x00000002U, "HTTP"},
};

std::uint32_t u32At(std::span<const std::byte> bytes, std::size_t offset) noexcept {
    std::uint32_t value = 0;
    for (std::size_t i = 0; i < 4; ++i) {
        value = value << 8U | std::to_integer<std::uint32_t>(bytes[offset + i]);
    }
    return value;
}

}  // namespace

std::array<std::byte, 8> rdtRequest(RdtCommand command) noexcept {
    const auto number = static_cast<std::uint16_t>(command);
    std::array<std::byte, 8> request{};  // the last four: a count of 0, without end
    request[0] = static_cast<std::byte>(kRequestHeader >> 8U);
    request[1] = static_cast<std::byte>(kRequestHeader & 0xFFU);
    request[2] = static_cast<std::byte>(number >> 8U);
    request[3] = static_cast<std::byte>(number & 0xFFU);
    return request;
}

Result<RdtRecord> parseRecord(std::span<const std::byte> bytes) {
    if (bytes.size() != kRecordSize) {
        return fail(Errc::invalid_argument,
                    fmt::format("a record of {} bytes, expected {}", bytes.size(), kRecordSize));
    }
    RdtRecord record{u32At(bytes, 0), u32At(bytes, 4), u32At(bytes, 8), {}};
    for (std::size_t i = 0; i < record.counts.size(); ++i) {
        record.counts[i] = static_cast<std::int32_t>(u32At(bytes, 12 + 4 * i));
    }
    return record;
}

bool isError(std::uint32_t status) noexcept {
    return status != 0 && status != (kSummary | kMonitorLatched);
}

std::string describeStatus(std::uint32_t status) {
    std::string causes;
    for (const auto& [mask, name] : kCauses) {
        if ((status & mask) != 0) {
            causes += (causes.empty() ? "" : ", ") + std::string(name);
        }
    }
    if (causes.empty()) {
        causes = status == 0 ? "healthy" : "unknown cause";
    }
    return fmt::format("{} (status {:08X})", causes, status);
}

}  // namespace metier::netft_driver
