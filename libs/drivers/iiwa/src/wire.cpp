#include "metier/iiwa_driver/wire.hpp"

#include <fmt/format.h>

#include <bit>
#include <cmath>
#include <optional>

#include "metier/base/numbers.hpp"

namespace metier::iiwa_driver {

namespace {

constexpr std::size_t kStateNumbers = 38;
// No axis of such an arm turns further, nor faster, nor does its flange get further away.
constexpr double kLargestPosition = 6.3;  // [rad]
constexpr double kLargestVelocity = 50;   // [rad/s]
constexpr double kLargestDistance = 10;   // [m]
constexpr double kLargestError = 1e6;

// First elements of the parts of a state: docs/protocols/iiwa.md#state.
constexpr std::size_t kExecuted = 0;
constexpr std::size_t kPosition = 1;
constexpr std::size_t kVelocity = 8;
constexpr std::size_t kJointTorque = 15;
constexpr std::size_t kPlace = 22;
constexpr std::size_t kOrientation = 25;
constexpr std::size_t kForce = 28;
constexpr std::size_t kTorque = 31;
constexpr std::size_t kLastError = 34;
constexpr std::size_t kForceConditionMet = 35;
constexpr std::size_t kReady = 36;
constexpr std::size_t kActive = 37;

using Numbers = std::array<double, kStateNumbers>;
using Problem = std::optional<StateError>;

template <typename Bits>
void put(Bits bits, std::span<std::byte> to) noexcept {
    for (std::size_t i = 0; i < sizeof(Bits); ++i) {
        to[i] = static_cast<std::byte>(bits >> (8 * (sizeof(Bits) - 1 - i)));
    }
}

template <typename Bits>
Bits take(std::span<const std::byte> from) noexcept {
    Bits bits = 0;
    for (std::size_t i = 0; i < sizeof(Bits); ++i) {
        bits = static_cast<Bits>(bits << 8) | std::to_integer<Bits>(from[i]);
    }
    return bits;
}

std::size_t putNumber(double value, Precision precision, std::span<std::byte> to) noexcept {
    if (precision == Precision::float64) {
        put(std::bit_cast<std::uint64_t>(value), to);
        return sizeof(double);
    }
    put(std::bit_cast<std::uint32_t>(static_cast<float>(value)), to);
    return sizeof(float);
}

Numbers takeNumbers(std::span<const std::byte> bytes, Precision precision) noexcept {
    Numbers numbers{};
    const std::size_t size = bytes.size() / kStateNumbers;
    for (std::size_t i = 0; i < kStateNumbers; ++i) {
        const auto part = bytes.subspan(i * size, size);
        numbers[i] = precision == Precision::float64
                         ? std::bit_cast<double>(take<std::uint64_t>(part))
                         : double{std::bit_cast<float>(take<std::uint32_t>(part))};
    }
    return numbers;
}

/// Elements that must be finite and may not be larger than this.
struct Range {
    std::size_t begin;
    std::size_t count;
    double largest;
};
constexpr std::array kRanges{
    Range{kPosition, kAxes, kLargestPosition}, Range{kVelocity, kAxes, kLargestVelocity},
    Range{kPlace, 3, kLargestDistance* kMillimetresPerMetre},
    Range{kOrientation, 3, kLargestPosition}, Range{kLastError, 1, kLargestError}};

Problem checkRange(const Numbers& numbers, const Range& range) noexcept {
    for (std::size_t i = range.begin; i < range.begin + range.count; ++i) {
        if (!std::isfinite(numbers[i])) {
            return StateError{StateError::Kind::not_finite, i, numbers[i]};
        }
        if (std::abs(numbers[i]) > range.largest) {
            return StateError{StateError::Kind::out_of_range, i, numbers[i]};
        }
    }
    return std::nullopt;
}

Problem checkFlags(const Numbers& numbers) noexcept {
    for (const auto i : {kExecuted, kForceConditionMet, kReady, kActive}) {
        if (numbers[i] != 0.0 && numbers[i] != 1.0) {
            return StateError{StateError::Kind::not_a_flag, i, numbers[i]};
        }
    }
    return std::nullopt;
}

Problem findProblem(const Numbers& numbers) noexcept {
    auto problem = checkFlags(numbers);
    for (const auto& range : kRanges) {
        problem = problem ? problem : checkRange(numbers, range);
    }
    return problem;
}

device::JointArray joints(const Numbers& numbers, std::size_t begin) noexcept {
    return device::JointArray(std::span(numbers).subspan(begin, kAxes));
}

std::array<double, 3> three(const Numbers& numbers, std::size_t begin) noexcept {
    return {numbers[begin], numbers[begin + 1], numbers[begin + 2]};
}

/// The cabinet turns by A about z, B about y, C about x: R = Rz(A) * Ry(B) * Rx(C).
Frame pose(const Numbers& numbers) noexcept {
    return {numbers[kPlace] / kMillimetresPerMetre,
            numbers[kPlace + 1] / kMillimetresPerMetre,
            numbers[kPlace + 2] / kMillimetresPerMetre,
            numbers[kOrientation + 2],
            numbers[kOrientation + 1],
            numbers[kOrientation]};
}

}  // namespace

CommandBytes encode(const Command& command, Precision precision) noexcept {
    CommandBytes encoded;
    std::span<std::byte> rest(encoded.bytes_);
    const auto append = [&](double value) {
        const auto size = putNumber(value, precision, rest);
        rest = rest.subspan(size);
        encoded.size_ += size;
    };
    append(static_cast<double>(command.code));
    for (const double argument : command.arguments) {
        append(argument);
    }
    return encoded;
}

Error toError(const StateError& error) {
    switch (error.kind) {
        case StateError::Kind::size:
            return {Errc::connection_lost,
                    fmt::format("a state of {:.0f} bytes, expected {} (or {} in double precision): "
                                "both sides must use the same precision",
                                error.value, stateSize(Precision::float32),
                                stateSize(Precision::float64))};
        case StateError::Kind::not_a_flag:
            return {Errc::connection_lost, fmt::format("state element {} is {}, neither 0 nor 1",
                                                       error.element, error.value)};
        case StateError::Kind::not_finite:
            return {Errc::connection_lost,
                    fmt::format("state element {} is not finite", error.element)};
        case StateError::Kind::out_of_range:
            return {Errc::connection_lost,
                    fmt::format("state element {} is {}, more than the arm can have", error.element,
                                error.value)};
    }
    return {Errc::connection_lost, "a state that cannot be read"};
}

tl::expected<CabinetState, StateError> parseState(std::span<const std::byte> bytes,
                                                  Precision precision) noexcept {
    if (bytes.size() != stateSize(precision)) {
        return tl::unexpected(
            StateError{StateError::Kind::size, 0, static_cast<double>(bytes.size())});
    }
    const auto numbers = takeNumbers(bytes, precision);
    if (const auto problem = findProblem(numbers)) {
        return tl::unexpected(*problem);
    }
    CabinetState state;
    state.executed = numbers[kExecuted] != 0.0;
    state.position = joints(numbers, kPosition);
    state.velocity = joints(numbers, kVelocity);
    state.joint_torque = joints(numbers, kJointTorque);
    state.pose = pose(numbers);
    state.force = three(numbers, kForce);
    state.torque = three(numbers, kTorque);
    state.last_error = static_cast<int>(numbers[kLastError]);
    state.force_condition_met = numbers[kForceConditionMet] != 0.0;
    state.ready = numbers[kReady] != 0.0;
    state.active = numbers[kActive] != 0.0;
    return state;
}

std::string_view errorText(int code) noexcept {
    switch (code) {
        case 0:
        case -10:
            return "";
        case -11:
            return "value not accepted";
        case -12:
            return "no such joint";
        case -13:
            return "synchronous motion failed";
        case -14:
            return "asynchronous motion failed";
        case -15:
            return "impedance not accepted";
        case -16:
            return "not possible in the present configuration";
        default:
            return "error of the robot application";
    }
}

}  // namespace metier::iiwa_driver
