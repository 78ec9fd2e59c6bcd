#include "crc.hpp"

namespace metier::wsg50_driver {
namespace {

constexpr std::uint16_t kStart = 0xFFFF;
constexpr std::uint32_t kPolynomial = 0x1021;

/// An entry of the usual table of the polynomial.
std::uint32_t entry(std::uint32_t index) noexcept {
    std::uint32_t value = index << 8U;
    for (int bit = 0; bit < 8; ++bit) {
        value = (value & 0x8000U) != 0 ? (value << 1U) ^ kPolynomial : value << 1U;
    }
    return value & 0xFFFFU;
}

}  // namespace

std::uint16_t crc(std::span<const std::byte> bytes) noexcept {
    std::uint32_t value = kStart;
    for (const auto byte : bytes) {
        value = entry((value ^ std::to_integer<std::uint32_t>(byte)) & 0xFFU) ^ (value >> 8U);
    }
    return static_cast<std::uint16_t>(value);
}

}  // namespace metier::wsg50_driver
