#include "wire.hpp"

#include <bit>

#include "metier/base/numbers.hpp"
#include "metier/motion/frame.hpp"

namespace metier::virtual_iiwa {

namespace {

std::size_t numberSize(Precision precision) noexcept {
    return precision == Precision::single_precision ? 4 : 8;
}

double decodeNumber(std::span<const std::byte> bytes, Precision precision) noexcept {
    std::uint64_t bits = 0;
    for (const std::byte byte : bytes) {
        bits = bits << 8U | std::to_integer<std::uint64_t>(byte);
    }
    return precision == Precision::single_precision
               ? static_cast<double>(std::bit_cast<float>(static_cast<std::uint32_t>(bits)))
               : std::bit_cast<double>(bits);
}

void appendNumber(std::vector<std::byte>& bytes, double number, Precision precision) {
    const auto bits = precision == Precision::single_precision
                          ? std::uint64_t{std::bit_cast<std::uint32_t>(static_cast<float>(number))}
                          : std::bit_cast<std::uint64_t>(number);
    for (auto left = numberSize(precision); left > 0; --left) {
        bytes.push_back(static_cast<std::byte>(bits >> 8U * (left - 1) & 0xFFU));
    }
}

}  // namespace

std::size_t commandSize(Precision precision) noexcept {
    return 8 * numberSize(precision);
}

Command decodeCommand(std::span<const std::byte> bytes, Precision precision) noexcept {
    const auto size = numberSize(precision);
    Command command;
    command.code = decodeNumber(bytes.first(size), precision);
    for (std::size_t i = 0; i < command.arguments.size(); ++i) {
        command.arguments[i] = decodeNumber(bytes.subspan((i + 1) * size, size), precision);
    }
    return command;
}

std::vector<std::byte> encodeState(const StateNumbers& state, Precision precision) {
    std::vector<std::byte> bytes;
    bytes.reserve(state.size() * numberSize(precision));
    for (const double number : state) {
        appendNumber(bytes, number, precision);
    }
    return bytes;
}

motion::Pose toPose(const std::array<double, 6>& xyzabc) {
    return motion::toPose({xyzabc[0] * kMillimetre, xyzabc[1] * kMillimetre,
                           xyzabc[2] * kMillimetre, xyzabc[5], xyzabc[4], xyzabc[3]});
}

std::array<double, 6> toNumbers(const motion::Pose& pose) {
    const auto frame = motion::toFrame(pose);
    return {frame.x / kMillimetre,
            frame.y / kMillimetre,
            frame.z / kMillimetre,
            frame.c,
            frame.b,
            frame.a};
}

}  // namespace metier::virtual_iiwa
