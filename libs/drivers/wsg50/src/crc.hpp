#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace metier::wsg50_driver {

/// The checksum of the gripper's frames, over all bytes before it; 0 over a frame with its own.
///
/// Not one of the usual CRC-16: the table is that of polynomial 0x1021, most significant bit
/// first, but the shift goes to the right. Source: docs/protocols/wsg50.md#checksum.
std::uint16_t crc(std::span<const std::byte> bytes) noexcept;

}  // namespace metier::wsg50_driver
