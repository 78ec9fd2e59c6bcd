#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <type_traits>

namespace metier::records {

/// A first-in-first-out queue of a fixed size between threads that neither locks nor allocates
/// after it was made.
///
/// Each slot has a turn: its position when it waits for a value, one more when it holds it. Who
/// moves the head or the tail owns the slot there until it sets the turn. Threading: any number of
/// threads put and take.
/// Source: D. Vyukov, bounded multi-producer multi-consumer queue.
template <typename T>
class SampleRing {
    static_assert(std::is_trivially_copyable_v<T>);

public:
    /// \param least how many values it holds at least, > 0; rounded up to a power of two
    explicit SampleRing(std::size_t least) {
        std::size_t size = 2;
        while (size < least) {
            size *= 2;
        }
        mask_ = size - 1;
        slots_ = std::make_unique<Slot[]>(size);  // NOLINT(*-avoid-c-arrays): atomics do not move
        for (std::size_t i = 0; i < size; ++i) {
            slots_[i].turn.store(i, std::memory_order_relaxed);
        }
    }

    /// False if it is full.
    bool tryPut(const T& value) noexcept {
        auto at = head_.load(std::memory_order_relaxed);
        while (true) {
            auto& slot = slots_[at & mask_];
            const auto turn = slot.turn.load(std::memory_order_acquire);
            if (turn == at) {
                if (head_.compare_exchange_weak(at, at + 1, std::memory_order_relaxed)) {
                    slot.value = value;
                    slot.turn.store(at + 1, std::memory_order_release);
                    return true;
                }
            } else if (turn < at) {
                return false;
            } else {
                at = head_.load(std::memory_order_relaxed);
            }
        }
    }

    /// The oldest; nothing if it is empty.
    std::optional<T> tryTake() noexcept {
        auto at = tail_.load(std::memory_order_relaxed);
        while (true) {
            auto& slot = slots_[at & mask_];
            const auto turn = slot.turn.load(std::memory_order_acquire);
            if (turn == at + 1) {
                if (tail_.compare_exchange_weak(at, at + 1, std::memory_order_relaxed)) {
                    const std::optional<T> value(slot.value);
                    slot.turn.store(at + mask_ + 1, std::memory_order_release);
                    return value;
                }
            } else if (turn <= at) {
                return std::nullopt;
            } else {
                at = tail_.load(std::memory_order_relaxed);
            }
        }
    }

    /// About, while others put and take.
    std::size_t size() const noexcept {
        const auto tail = tail_.load(std::memory_order_relaxed);
        const auto head = head_.load(std::memory_order_relaxed);
        return head > tail ? head - tail : 0;
    }
    std::size_t capacity() const noexcept { return mask_ + 1; }

private:
    struct Slot {
        std::atomic<std::size_t> turn{0};
        T value{};
    };

    std::size_t mask_ = 0;
    std::unique_ptr<Slot[]> slots_;  // NOLINT(*-avoid-c-arrays): atomics do not move
    std::atomic<std::size_t> head_{0};
    std::atomic<std::size_t> tail_{0};
};

}  // namespace metier::records
