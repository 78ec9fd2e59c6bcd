#pragma once

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
    PayloadWriter& f32(double value);
    PayloadWriter& raw(std::span<const std::byte> bytes);
    PayloadWriter& text(std::string_view value) { return raw(std::as_bytes(std::span(value))); }

    const std::vector<std::byte>& bytes() const noexcept { return bytes_; }

private:
    PayloadWriter& number(std::uint32_t value, int size);

    std::vector<std::byte> bytes_;
};

/// Reads a payload whose length was checked before; beyond its end everything is 0.
class PayloadReader {
public:
    explicit PayloadReader(std::span<const std::byte> bytes) noexcept : bytes_(bytes) {}

    std::uint8_t u8() noexcept { return static_cast<std::uint8_t>(number(1)); }
    std::uint16_t u16() noexcept { return static_cast<std::uint16_t>(number(2)); }
    double f32() noexcept;

private:
    std::uint32_t number(std::size_t size) noexcept;

    std::span<const std::byte> bytes_;
};

}  // namespace metier::virtual_wsg50
