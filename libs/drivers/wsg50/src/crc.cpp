#include "crc.hpp"

#include <array>

namespace metier::wsg50_driver {
namespace {

constexpr std::uint16_t kStart = 0xFFFF;
constexpr std::uint32_t kPolynomial = 0x1021;

constexpr std::array<std::uint16_t, 256> makeTable() {
    std::array<std::uint16_t, 256> table{};
    for (std::uint32_t byte = 0; byte < table.size(); ++byte) {
        std::uint32_t value = byte << 8;
        for (int bit = 0; bit < 8; ++bit) {
            value = (value & 0x8000U) != 0 ? (value << 1) ^ kPolynomial : value << 1;
        }
        table[byte] = static_cast<std::uint16_t>(value);
    }
    return table;
}

constexpr auto kTable = makeTable();

}  // namespace

std::uint16_t crc(std::span<const std::byte> bytes) noexcept {
    std::uint32_t value = kStart;
    for (const auto byte : bytes) {
        const auto index = (value ^ std::to_integer<std::uint32_t>(byte)) & 0xFFU;
        value = kTable[index] ^ (value >> 8);
    }
    return static_cast<std::uint16_t>(value);
}

}  // namespace metier::wsg50_driver
