#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <span>

namespace metier::virtual_controller {

/// What is wrong with the cable of a virtual controller. Every port of it obeys.
///
/// Threading: any thread.
struct LinkFaults {
    /// Nothing is sent, received or accepted, and nobody is told: a pulled cable.
    std::atomic<bool> cut{false};
    /// Everything that is sent comes so much later [ms].
    std::atomic<std::uint32_t> delay_ms{0};
    /// So many of the next packets that are sent have one byte changed.
    std::atomic<std::uint32_t> garble{0};

    /// Changes a byte of a packet that is to be sent, if it is one of those. In turns it is the
    /// first byte and one in the middle, then in the middle of the halves, of the quarters, ...
    void spoil(std::span<std::byte> packet) noexcept;

private:
    std::atomic<std::uint32_t> spoilt_{0};
};

}  // namespace metier::virtual_controller
