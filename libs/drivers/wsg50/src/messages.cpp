#include "messages.hpp"

#include <fmt/format.h>

#include <array>
#include <bit>
#include <cmath>
#include <string_view>

#include "metier/base/numbers.hpp"

namespace metier::wsg50_driver {
namespace {

constexpr std::size_t kStatusSize = 2;
constexpr std::size_t kFloatSize = 4;
// No gripper of the series is near it; larger values are no measurements.
constexpr double kLargestValue = 1e6;

constexpr std::array<std::string_view, 31> kStatusNames{
    "success",
    "not available",
    "no sensor",
    "not initialised",
    "already running",
    "feature not supported",
    "inconsistent data",
    "timeout",
    "read error",
    "write error",
    "insufficient resources",
    "checksum error",
    "no parameters expected",
    "not enough parameters",
    "unknown command",
    "format error",
    "access denied",
    "already open",
    "command failed",
    "command aborted",
    "invalid handle",
    "not found",
    "not open",
    "I/O error",
    "invalid parameter",
    "index out of bounds",
    "command pending",
    "overrun",
    "range error",
    "axis blocked",
    "file exists",
};

struct FaultName {
    unsigned bit;
    std::string_view name;
};

constexpr std::array kFaultNames{
    FaultName{12, "fast stop"},    FaultName{14, "temperature fault"},
    FaultName{15, "power fault"},  FaultName{16, "current fault"},
    FaultName{17, "finger fault"},
};

constexpr std::array<std::string_view, 8> kGraspingNames{
    "idle",    "grasping",  "no part found", "part lost",
    "holding", "releasing", "positioning",   "error",
};

Result<void> checkSize(std::span<const std::byte> data, std::size_t size, std::string_view what) {
    if (data.size() == size) {
        return {};
    }
    return fail(Errc::invalid_argument,
                fmt::format("{}: {} bytes, expected {}", what, data.size(), size));
}

std::uint32_t u32At(std::span<const std::byte> data, std::size_t offset) noexcept {
    std::uint32_t value = 0;
    for (std::size_t i = 0; i < kFloatSize; ++i) {
        value |= std::to_integer<std::uint32_t>(data[offset + i]) << (8 * i);
    }
    return value;
}

double f32At(std::span<const std::byte> data, std::size_t offset) noexcept {
    return std::bit_cast<float>(u32At(data, offset));
}

Result<double> parseFloat(std::span<const std::byte> data, std::string_view what) {
    METIER_TRY(checkSize(data, kFloatSize, what));
    const double value = f32At(data, 0);
    if (!(std::abs(value) <= kLargestValue)) {
        return fail(Errc::invalid_argument, fmt::format("{}: {} is no value", what, value));
    }
    return value;
}

Result<void> checkOrder(double low, double high, std::string_view what) {
    if (low >= 0.0 && low < high && high <= kLargestValue) {
        return {};
    }
    return fail(Errc::invalid_argument, fmt::format("limits: {} from {} to {}", what, low, high));
}

}  // namespace

std::string describe(Status status) {
    const auto number = static_cast<std::size_t>(status);
    return fmt::format("{} (status {})",
                       number < kStatusNames.size() ? kStatusNames[number] : "unknown", number);
}

Result<Reply> parseReply(const Frame& frame) {
    if (frame.payload.size() < kStatusSize) {
        return fail(Errc::invalid_argument, fmt::format("reply {:02X}: no status", frame.id));
    }
    const auto status = std::to_integer<std::uint32_t>(frame.payload[0]) |
                        std::to_integer<std::uint32_t>(frame.payload[1]) << 8;
    return Reply{static_cast<CommandId>(frame.id), static_cast<Status>(status),
                 frame.payload.subspan(kStatusSize)};
}

std::string SystemState::faultText() const {
    std::string text;
    for (const auto& [bit, name] : kFaultNames) {
        if (has(bit)) {
            text += (text.empty() ? "" : ", ") + std::string(name);
        }
    }
    return text;
}

std::string_view toString(GraspingState state) noexcept {
    return kGraspingNames[static_cast<std::size_t>(state) % kGraspingNames.size()];
}

Result<SystemState> parseSystemState(std::span<const std::byte> data) {
    METIER_TRY(checkSize(data, 4, "system state"));
    return SystemState(u32At(data, 0));
}

Result<GraspingState> parseGraspingState(std::span<const std::byte> data) {
    METIER_TRY(checkSize(data, 1, "grasping state"));
    const auto number = std::to_integer<std::size_t>(data[0]);
    if (number >= kGraspingNames.size()) {
        return fail(Errc::invalid_argument, fmt::format("grasping state: {} is none", number));
    }
    return static_cast<GraspingState>(number);
}

Result<double> parseWidth(std::span<const std::byte> data) {
    return parseFloat(data, "width").map([](double width_mm) { return width_mm * kMillimetre; });
}

Result<double> parseForce(std::span<const std::byte> data) {
    return parseFloat(data, "force");
}

Result<Limits> parseLimits(std::span<const std::byte> data) {
    constexpr std::size_t kCount = 8;
    METIER_TRY(checkSize(data, kCount * kFloatSize, "limits"));
    const auto value = [&](std::size_t index) { return f32At(data, index * kFloatSize); };
    const Limits limits{
        .stroke = value(0) * kMillimetre,
        .min_speed = value(1) * kMillimetre,
        .max_speed = value(2) * kMillimetre,
        .min_acceleration = value(3) * kMillimetre,
        .max_acceleration = value(4) * kMillimetre,
        .min_force = value(5),
        .max_force = value(6),
    };
    return checkOrder(0.0, limits.stroke, "width")
        .and_then([&] { return checkOrder(limits.min_speed, limits.max_speed, "speed"); })
        .and_then([&] {
            return checkOrder(limits.min_acceleration, limits.max_acceleration, "acceleration");
        })
        .and_then([&] { return checkOrder(limits.min_force, limits.max_force, "force"); })
        .map([&] { return limits; });
}

Command homeCommand() noexcept {
    constexpr std::uint8_t kDefaultDirection = 0;
    return Command(CommandId::home).u8(kDefaultDirection);
}

Command positionCommand(double width, double speed) noexcept {
    constexpr std::uint8_t kAbsoluteStopOnBlock = 0x02;
    return Command(CommandId::position)
        .u8(kAbsoluteStopOnBlock)
        .f32(width / kMillimetre)
        .f32(speed / kMillimetre);
}

Command graspCommand(double width, double speed) noexcept {
    return Command(CommandId::grasp).f32(width / kMillimetre).f32(speed / kMillimetre);
}

Command releaseCommand(double width, double speed) noexcept {
    return Command(CommandId::release).f32(width / kMillimetre).f32(speed / kMillimetre);
}

Command acknowledgeCommand() noexcept {
    return Command(CommandId::acknowledge).u8('a').u8('c').u8('k');
}

Command accelerationCommand(double acceleration) noexcept {
    return Command(CommandId::set_acceleration).f32(acceleration / kMillimetre);
}

Command forceLimitCommand(double force) noexcept {
    return Command(CommandId::set_force_limit).f32(force);
}

Command updateCommand(CommandId value, std::chrono::milliseconds period) noexcept {
    constexpr std::uint8_t kEveryPeriod = 0x01;
    return Command(value).u8(kEveryPeriod).u16(static_cast<std::uint16_t>(period.count()));
}

}  // namespace metier::wsg50_driver
