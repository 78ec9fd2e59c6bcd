#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <string_view>
#include <vector>

// Frames as a gripper would make them, written without the driver's codec.
namespace metier::wsg50_driver::testing {

using Bytes = std::vector<std::byte>;

inline Bytes bytes(std::initializer_list<int> values) {
    Bytes result;
    for (const int value : values) {
        result.push_back(static_cast<std::byte>(value));
    }
    return result;
}

inline Bytes operator+(Bytes left, const Bytes& right) {
    left.insert(left.end(), right.begin(), right.end());
    return left;
}

inline Bytes u16(unsigned value) {
    return bytes({static_cast<int>(value & 0xFFU), static_cast<int>(value >> 8U & 0xFFU)});
}

inline Bytes u32(std::uint32_t value) {
    return u16(value & 0xFFFFU) + u16(value >> 16U);
}

inline Bytes f32(float value) {
    return u32(std::bit_cast<std::uint32_t>(value));
}

inline Bytes text(std::string_view value) {
    Bytes result;
    for (const char letter : value) {
        result.push_back(static_cast<std::byte>(letter));
    }
    return result;
}

/// The gripper's checksum, bit by bit.
inline unsigned checksum(const Bytes& over) {
    unsigned value = 0xFFFF;
    for (const auto byte : over) {
        unsigned entry = ((value ^ std::to_integer<unsigned>(byte)) & 0xFFU) << 8U;
        for (int bit = 0; bit < 8; ++bit) {
            entry = (entry & 0x8000U) != 0 ? (entry << 1U ^ 0x1021U) & 0xFFFFU : entry << 1U;
        }
        value = entry ^ value >> 8U;
    }
    return value;
}

inline Bytes frame(int id, const Bytes& payload) {
    const auto head =
        bytes({0xAA, 0xAA, 0xAA, id}) + u16(static_cast<unsigned>(payload.size())) + payload;
    return head + u16(checksum(head));
}

inline Bytes reply(int id, unsigned status, const Bytes& data = {}) {
    return frame(id, u16(status) + data);
}

// Status codes.
inline constexpr unsigned kSuccess = 0;
inline constexpr unsigned kAccessDenied = 16;
inline constexpr unsigned kFailed = 18;
inline constexpr unsigned kAborted = 19;
inline constexpr unsigned kPending = 26;
inline constexpr unsigned kRangeError = 28;
inline constexpr unsigned kBlocked = 29;

// System state.
inline constexpr std::uint32_t kReferenced = 1U << 0U;
inline constexpr std::uint32_t kMoving = 1U << 1U;
inline constexpr std::uint32_t kFastStop = 1U << 12U;

// Grasping state.
inline constexpr int kIdle = 0;
inline constexpr int kNoPart = 2;
inline constexpr int kPartLost = 3;
inline constexpr int kHolding = 4;
inline constexpr int kReleasing = 5;

inline Bytes systemState(std::uint32_t bits) {
    return reply(0x40, kSuccess, u32(bits));
}
inline Bytes graspingState(int state) {
    return reply(0x41, kSuccess, bytes({state}));
}
inline Bytes width(float width_mm) {
    return reply(0x43, kSuccess, f32(width_mm));
}
inline Bytes force(float force) {
    return reply(0x45, kSuccess, f32(force));
}

/// The usual limits of a WSG 50.
inline Bytes limits() {
    Bytes data;
    for (const float value : {110.0F, 5.0F, 420.0F, 100.0F, 5000.0F, 5.0F, 80.0F, 120.0F}) {
        data = data + f32(value);
    }
    return reply(0x53, kSuccess, data);
}

}  // namespace metier::wsg50_driver::testing
