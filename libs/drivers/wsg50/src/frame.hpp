#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

namespace metier::wsg50_driver {

/// Commands of the gripper's protocol.
enum class CommandId : std::uint8_t {
    disconnect = 0x07,
    home = 0x20,
    position = 0x21,
    stop = 0x22,
    acknowledge = 0x24,
    grasp = 0x25,
    release = 0x26,
    set_acceleration = 0x30,
    set_force_limit = 0x32,
    get_force_limit = 0x33,
    system_state = 0x40,
    grasping_state = 0x41,
    width = 0x43,
    force = 0x45,
    limits = 0x53,
};

/// One frame to the gripper, built in place; neither allocates nor fails.
class Command {
public:
    explicit Command(CommandId id) noexcept;

    // Little-endian, in the order of the calls; at most kLargestPayload bytes in all.
    Command& u8(std::uint8_t value) noexcept;
    Command& u16(std::uint16_t value) noexcept;
    Command& f32(double value) noexcept;

    CommandId id() const noexcept { return id_; }
    /// The whole frame, with length and checksum. Valid as long as the command, until it changes.
    std::span<const std::byte> bytes() noexcept;

private:
    static constexpr std::size_t kLargestPayload = 16;
    static constexpr std::size_t kHeader = 6;

    CommandId id_;
    std::size_t end_ = kHeader;
    std::array<std::byte, kHeader + kLargestPayload + 2> bytes_{};
};

/// One frame from the gripper.
struct Frame {
    std::uint8_t id = 0;
    std::span<const std::byte> payload{};
};

/// Cuts the gripper's stream of bytes into frames. Bytes that are no frame, and frames with a wrong
/// checksum, are skipped.
///
/// Does not allocate. Threading: one thread.
class FrameReader {
public:
    /// Longest payload that is taken for one; the gripper's own are below 100 bytes.
    static constexpr std::size_t kLargestPayload = 512;

    /// Space for the next bytes; never empty after next() returned nothing.
    std::span<std::byte> space() noexcept;
    /// \param count how many of space() were written
    void received(std::size_t count) noexcept;
    /// The next whole frame; nothing until more bytes come. Its payload is valid until the next
    /// call of any function here.
    std::optional<Frame> next() noexcept;

private:
    enum class Found : std::uint8_t { frame, more, nothing };
    Found look() noexcept;

    std::array<std::byte, 2 * (kLargestPayload + 8)> bytes_{};
    std::size_t begin_ = 0;
    std::size_t end_ = 0;
};

}  // namespace metier::wsg50_driver
