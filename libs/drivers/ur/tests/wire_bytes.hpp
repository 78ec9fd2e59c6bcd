#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>
#include <vector>

namespace metier::ur_driver {

/// Bytes as a controller sends them, put together by hand: the tests' own encoding.
class WireBytes {
public:
    WireBytes& word(std::uint64_t value, int bytes) {
        for (int shift = 8 * (bytes - 1); shift >= 0; shift -= 8) {
            bytes_.push_back(static_cast<std::byte>(value >> static_cast<unsigned>(shift)));
        }
        return *this;
    }
    WireBytes& u8(std::uint64_t value) { return word(value, 1); }
    WireBytes& u16(std::uint64_t value) { return word(value, 2); }
    WireBytes& u32(std::uint64_t value) { return word(value, 4); }
    WireBytes& i32(std::int64_t value) { return word(static_cast<std::uint64_t>(value), 4); }
    WireBytes& u64(std::uint64_t value) { return word(value, 8); }
    WireBytes& f64(double value) { return u64(std::bit_cast<std::uint64_t>(value)); }
    template <typename Values>
    WireBytes& f64s(const Values& values) {
        for (const double value : values) {
            f64(value);
        }
        return *this;
    }
    WireBytes& text(std::string_view value) {
        for (const char character : value) {
            u8(static_cast<unsigned char>(character));
        }
        return *this;
    }
    WireBytes& append(const std::vector<std::byte>& other) {
        bytes_.insert(bytes_.end(), other.begin(), other.end());
        return *this;
    }
    const std::vector<std::byte>& bytes() const { return bytes_; }
    std::size_t size() const { return bytes_.size(); }

private:
    std::vector<std::byte> bytes_;
};

/// "00 05 56" and so on, as a document prints bytes.
inline std::vector<std::byte> fromHex(const std::string& hex) {
    std::vector<std::byte> bytes;
    const char* rest = hex.c_str();
    char* end = nullptr;
    for (auto value = std::strtoul(rest, &end, 16); end != rest;
         value = std::strtoul(rest, &end, 16)) {
        bytes.push_back(static_cast<std::byte>(value));
        rest = end;
    }
    return bytes;
}

inline std::vector<std::byte> rtdePackage(char type, const std::vector<std::byte>& payload) {
    return WireBytes()
        .u16(3 + payload.size())
        .u8(static_cast<unsigned char>(type))
        .append(payload)
        .bytes();
}

/// A package of the primary interface around its parts.
inline std::vector<std::byte> primaryPackage(int type, const std::vector<std::byte>& payload) {
    return WireBytes()
        .u32(5 + payload.size())
        .u8(static_cast<unsigned>(type))
        .append(payload)
        .bytes();
}

}  // namespace metier::ur_driver
