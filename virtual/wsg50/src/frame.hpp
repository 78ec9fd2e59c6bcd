#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace metier::virtual_wsg50 {

/// The gripper's own checksum, which no usual library has: the table of the polynomial 0x1021 for
/// the most significant bit first, run through as if the least significant bit came first.
/// Over a frame with its checksum it is 0. Pure.
std::uint16_t checksum(std::span<const std::byte> bytes) noexcept;

/// One binary message of the gripper, in either direction.
struct Frame {
    std::uint8_t id = 0;
    std::vector<std::byte> payload;
    bool intact = true;  ///< the checksum was right
};

/// AA AA AA, id, length, payload, checksum; numbers little-endian.
/// \param payload at most 65535 bytes
std::vector<std::byte> encode(std::uint8_t id, std::span<const std::byte> payload);

/// Finds the frames in a stream of bytes; skips bytes before a preamble. Keeps the bytes of one
/// frame at most, 65543, besides those fed last.
///
/// Threading: one thread.
class FrameReader {
public:
    void feed(std::span<const std::byte> bytes);
    /// The next whole frame; call until there is none after every feed().
    std::optional<Frame> next();

private:
    void skipToPreamble();

    std::vector<std::byte> buffer_;
};

}  // namespace metier::virtual_wsg50
