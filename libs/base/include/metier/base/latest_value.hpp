#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <type_traits>

namespace metier {

/// Hands the newest value from one thread to another; older ones are overwritten:
///
///     LatestValue<double> speed;
///     speed.write(0.5);                 // one thread
///     const double now = speed.read();  // another one
///
/// Threading: one writer thread, one reader thread. Neither locks, waits or allocates, so a cycle
/// thread may be either. Several readers need one LatestValue each, or a device::SharedValue.
template <typename T>
class LatestValue {
    static_assert(std::is_trivially_copyable_v<T>, "copied between threads byte by byte");

public:
    /// Begins with `initial`, which read() returns until the first write().
    explicit LatestValue(const T& initial = T{}) { buffers_.fill(initial); }

    /// Publishes a value; one that was not read is lost. Writer only.
    void write(const T& value) noexcept {
        buffers_[write_index_] = value;
        write_index_ = middle_.exchange(write_index_ | kFresh, std::memory_order_acq_rel) & kIndex;
    }

    /// Newest published value; the initial one if none was published. Reader only. The reference is
    /// valid until the next call.
    const T& read() noexcept {
        if (hasNew()) {
            read_index_ = middle_.exchange(read_index_, std::memory_order_acq_rel) & kIndex;
        }
        return buffers_[read_index_];
    }

    /// Reports whether a value was published since the last read(). Reader only.
    bool hasNew() const noexcept { return (middle_.load(std::memory_order_acquire) & kFresh) != 0; }

private:
    // Bits of middle_: the index of the buffer that neither side holds, and whether it is newer
    // than the reader's.
    static constexpr std::uint8_t kFresh = 4;
    static constexpr std::uint8_t kIndex = 3;

    // Three buffers: one belongs to the writer, one to the reader, one is in the middle. Each side
    // gives its buffer for the middle one in a single exchange, so neither ever sees half a value.
    std::array<T, 3> buffers_{};
    std::atomic<std::uint8_t> middle_{1};
    std::uint8_t write_index_ = 0;
    std::uint8_t read_index_ = 2;
};

}  // namespace metier
