#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <span>

namespace metier::virtual_controller {

/// Faults of the cable of a virtual controller. They apply to every port of it.
///
/// Threading: any thread.
///
/// While the cable is cut, sent bytes wait in the queue, 1 MB per peer at most, and go out once it
/// is plugged in again; further ones are dropped.
struct LinkFaults {
    /// A pulled cable: nothing is sent, received or accepted, and neither side is notified.
    std::atomic<bool> cut{false};
    /// Delay of all sent bytes [ms]; 0: none.
    std::atomic<std::uint32_t> delay_ms{0};
    /// Number of the next sent packets that get one changed byte.
    std::atomic<std::uint32_t> garble{0};

    /// Changes a byte of a packet before it is sent, if `garble` asks for it. The place of the byte
    /// goes round: the first one, the middle one, the middle of the halves, of the quarters, ...
    /// An empty packet uses up no garbled one. One bit pattern, 0x55, is put over the byte.
    void spoil(std::span<std::byte> packet) noexcept;

private:
    std::atomic<std::uint32_t> spoilt_{0};
};

}  // namespace metier::virtual_controller
