#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <cstring>
#include <type_traits>

namespace metier::device {

/// Hands the newest value from one thread to any number of readers, such as an arm's state from its
/// cycle thread. For one reader only, LatestValue needs no second attempt.
///
/// Threading: one writer thread, which never waits, so a cycle thread may write. A reader that
/// meets a write reads again until it has a whole value. No call locks or allocates.
///
///     SharedValue<ArmState> published;
///     published.write(state);                   // cycle thread, once per cycle
///     const ArmState now = published.read();    // any thread: of one cycle, never mixed
template <typename T>
class SharedValue {
    static_assert(std::is_trivially_copyable_v<T>, "copied between threads word by word");

public:
    /// Begins with `initial`, which read() returns until the first write().
    /// T needs no locking, since it is copied word by word; large values make a second attempt
    /// likelier.
    explicit SharedValue(const T& initial = T{}) noexcept { write(initial); }

    /// Publishes a value. Writer only; two writers at a time would mix their values.
    void write(const T& value) noexcept {
        std::array<std::uint64_t, kWords> words{};
        std::memcpy(words.data(), &value, sizeof(T));
        const auto version = version_.load(std::memory_order_relaxed);
        version_.store(version + 1, std::memory_order_relaxed);  // odd: being written
        for (std::size_t i = 0; i < kWords; ++i) {
            words_[i].store(words[i], std::memory_order_release);
        }
        version_.store(version + 2, std::memory_order_release);
    }

    /// The newest published value, whole. Any thread.
    /// Several calls may give the same value; one after the other they never go back to an older
    /// one.
    T read() const noexcept {
        std::array<std::uint64_t, kWords> words{};
        std::uint64_t before = 0;
        std::uint64_t after = 0;
        do {
            before = version_.load(std::memory_order_acquire);
            for (std::size_t i = 0; i < kWords; ++i) {
                words[i] = words_[i].load(std::memory_order_acquire);
            }
            after = version_.load(std::memory_order_relaxed);
        } while (before != after || before % 2 != 0);
        T value{};
        std::memcpy(static_cast<void*>(&value), words.data(), sizeof(T));
        return value;
    }

private:
    // A sequence lock: version_ is odd while words_ change and rises by two per write; a reader
    // takes only words between two equal, even versions.
    static constexpr std::size_t kWords = (sizeof(T) + 7) / 8;

    std::array<std::atomic<std::uint64_t>, kWords> words_{};
    std::atomic<std::uint64_t> version_{0};
};

}  // namespace metier::device
