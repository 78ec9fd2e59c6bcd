#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>

namespace metier::ur_driver {

/// Reads big-endian values one after another. A read past the end gives zero and is remembered, so
/// that a parser asks once, at its end, whether all was there.
///
/// Threading: one thread. Never allocates; texts and spans point into the bytes that were given.
class ByteReader {
public:
    explicit ByteReader(std::span<const std::byte> bytes) noexcept : rest_(bytes) {}

    /// Reports whether every value read so far was there.
    bool ok() const noexcept { return ok_; }
    std::size_t remaining() const noexcept { return rest_.size(); }

    std::span<const std::byte> take(std::size_t count) noexcept {
        if (count > rest_.size()) {
            ok_ = false;
            rest_ = {};
            return {};
        }
        const auto taken = rest_.first(count);
        rest_ = rest_.subspan(count);
        return taken;
    }

    template <std::unsigned_integral T>
    T number() noexcept {
        std::uint64_t value = 0;
        for (const std::byte byte : take(sizeof(T))) {
            value = (value << 8U) | std::to_integer<std::uint64_t>(byte);
        }
        return static_cast<T>(value);
    }
    template <std::signed_integral T>
    T number() noexcept {
        return std::bit_cast<T>(number<std::make_unsigned_t<T>>());
    }

    std::uint8_t uint8() noexcept { return number<std::uint8_t>(); }
    double float64() noexcept { return std::bit_cast<double>(number<std::uint64_t>()); }

    template <std::size_t size>
    std::array<double, size> float64s() noexcept {
        std::array<double, size> values{};
        for (double& value : values) {
            value = float64();
        }
        return values;
    }

    std::string_view text(std::size_t length) noexcept {
        const auto bytes = take(length);
        // The characters of a text are bytes; char may look at any object.
        return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};  // NOLINT
    }
    std::string_view restAsText() noexcept { return text(rest_.size()); }

private:
    std::span<const std::byte> rest_;
    bool ok_ = true;
};

/// A text from the wire, fit to be shown: one line of at most 300 printable characters.
inline std::string printable(std::string_view raw) {
    std::string text(raw.substr(0, 300));
    std::ranges::replace_if(
        text, [](char c) { return c < 0x20 || c >= 0x7f; }, ' ');
    text.erase(text.find_last_not_of(' ') + 1);
    return text;
}

/// Writes big-endian values one after another to an output iterator of bytes.
template <typename Output>
class ByteWriter {
public:
    explicit ByteWriter(Output out) : out_(out) {}

    template <std::integral T>
    void number(T value) {
        const auto bits = static_cast<std::uint64_t>(value);
        for (std::size_t i = sizeof(T); i-- > 0;) {
            *out_++ = static_cast<std::byte>(bits >> (8U * i));
        }
    }
    void float64(double value) { number(std::bit_cast<std::uint64_t>(value)); }
    void text(std::string_view value) {
        out_ = std::ranges::copy(std::as_bytes(std::span(value)), out_).out;
    }

private:
    Output out_;
};

}  // namespace metier::ur_driver
