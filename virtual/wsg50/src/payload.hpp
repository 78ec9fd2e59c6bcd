#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

namespace metier::virtual_wsg50 {

/// Writes a payload: little-endian numbers one after the other.
class PayloadWriter {
public:
    PayloadWriter& u8(std::uint8_t value) { return number(value, 1); }
    PayloadWriter& u16(std::uint16_t value) { return number(value, 2); }
    PayloadWriter& u32(std::uint32_t value) { return number(value, 4); }
    PayloadWriter& f32(double value) {
        return u32(std::bit_cast<std::uint32_t>(static_cast<float>(value)));
    }
    PayloadWriter& raw(std::span<const std::byte> bytes) {
        bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
        return *this;
    }
    PayloadWriter& text(std::string_view value) { return raw(std::as_bytes(std::span(value))); }

    const std::vector<std::byte>& bytes() const noexcept { return bytes_; }

private:
    PayloadWriter& number(std::uint32_t value, int size) {
        for (; size > 0; --size, value >>= 8U) {
            bytes_.push_back(static_cast<std::byte>(value & 0xFFU));
        }
        return *this;
    }

    std::vector<std::byte> bytes_;
};

/// Reads a payload whose length was checked before; beyond its end everything is 0.
class PayloadReader {
public:
    explicit PayloadReader(std::span<const std::byte> bytes) noexcept : bytes_(bytes) {}

    std::uint8_t u8() noexcept { return static_cast<std::uint8_t>(number(1)); }
    std::uint16_t u16() noexcept { return static_cast<std::uint16_t>(number(2)); }
    double f32() noexcept { return std::bit_cast<float>(number(4)); }

private:
    std::uint32_t number(std::size_t size) noexcept {
        const auto taken = bytes_.first(std::min(size, bytes_.size()));
        bytes_ = bytes_.subspan(taken.size());
        std::uint32_t value = 0;
        std::uint32_t shift = 0;
        for (const std::byte byte : taken) {
            value |= std::to_integer<std::uint32_t>(byte) << shift;
            shift += 8;
        }
        return value;
    }

    std::span<const std::byte> bytes_;
};

}  // namespace metier::virtual_wsg50
