#pragma once

#include <bit>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <type_traits>
#include <vector>

namespace metier::virtual_controller {

/// Content of a package.
using Bytes = std::vector<std::byte>;

/// Appends numbers to a package, most significant byte first (big-endian):
///
///     send(ByteWriter().put(std::uint16_t{8}).put(0.5).text("ok").content());
///
/// Threading: a value; one thread.
class ByteWriter {
public:
    /// Appends one number in the size of its type; a bool as one byte, floating point as IEEE 754.
    template <typename T>
    requires std::is_arithmetic_v<T> ByteWriter& put(T value) {
        if constexpr (std::same_as<T, bool>) {
            return put(static_cast<std::uint8_t>(value));
        } else if constexpr (std::same_as<T, double>) {
            return put(std::bit_cast<std::uint64_t>(value));
        } else if constexpr (std::same_as<T, float>) {
            return put(std::bit_cast<std::uint32_t>(value));
        } else {
            const auto bits = static_cast<std::uint64_t>(value);
            for (std::size_t i = sizeof(T); i-- > 0;) {
                bytes_.push_back(static_cast<std::byte>(bits >> (8 * i)));
            }
            return *this;
        }
    }
    template <typename Range>
    requires requires(const Range& range) { range.begin(); }
    /// Appends every element of a range, in order.
    /// Each element is written in the size of its own type; the number of elements is not written.
    ByteWriter& putAll(const Range& values) {
        for (const auto& value : values) {
            put(value);
        }
        return *this;
    }
    /// Appends the bytes of a text, without an end.
    /// Neither its length nor a zero byte is added; a protocol that needs one puts it itself.
    ByteWriter& text(std::string_view text) {
        const auto bytes = std::as_bytes(std::span(text));
        bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
        return *this;
    }
    /// Appends that many zero bytes.
    /// Place holders for fields that the virtual controller does not fill.
    ByteWriter& zeros(std::size_t count) {
        bytes_.resize(bytes_.size() + count);
        return *this;
    }
    /// Appends bytes as they are.
    /// For example a package inside another one, whose length must be known first.
    ByteWriter& bytes(std::span<const std::byte> bytes) {
        bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
        return *this;
    }
    /// All bytes so far; valid until the next call.
    /// Copy them if they have to outlive this writer.
    const Bytes& content() const { return bytes_; }

private:
    Bytes bytes_;
};

/// Takes numbers from a package, most significant byte first. Reading beyond its end gives zeros
/// and is noted: test complete() once at the end.
///
/// Threading: a value; one thread. The bytes must outlive it.
///
///     ByteReader reader(package);
///     const auto size = reader.get<std::uint16_t>();
///     const auto type = reader.get<std::uint8_t>();
///     if (!reader.complete()) { peer.reset(); }   // the package was too short for its header
class ByteReader {
public:
    /// Begins at the first byte. Copies nothing.
    explicit ByteReader(std::span<const std::byte> bytes) : bytes_(bytes) {}

    /// Takes the next number, as ByteWriter::put() wrote it.
    template <typename T>
    requires std::is_arithmetic_v<T> T get() {
        if constexpr (std::same_as<T, bool>) {
            return get<std::uint8_t>() != 0;
        } else if constexpr (std::same_as<T, double>) {
            return std::bit_cast<double>(get<std::uint64_t>());
        } else if constexpr (std::same_as<T, float>) {
            return std::bit_cast<float>(get<std::uint32_t>());
        } else {
            if (bytes_.size() < sizeof(T)) {
                complete_ = false;
                bytes_ = {};
                return T{};
            }
            std::uint64_t bits = 0;
            for (std::size_t i = 0; i < sizeof(T); ++i) {
                bits = bits << 8U | std::to_integer<std::uint64_t>(bytes_[i]);
            }
            bytes_ = bytes_.subspan(sizeof(T));
            return static_cast<T>(bits);
        }
    }
    /// The bytes that were not taken yet, as text; does not take them.
    std::string_view rest() const {
        return {reinterpret_cast<const char*>(bytes_.data()), bytes_.size()};  // NOLINT: text
    }
    /// Number of bytes that were not taken yet.
    std::size_t left() const { return bytes_.size(); }
    /// Reports whether every requested byte was there: false after a get() beyond the end.
    /// Once false it stays false, and left() is 0 from then on.
    bool complete() const { return complete_; }

private:
    // The bytes that were not taken; empty after a read beyond the end, so that every later get()
    // gives zero as well instead of a number from the wrong place.
    std::span<const std::byte> bytes_;
    bool complete_ = true;
};

}  // namespace metier::virtual_controller
