#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace metier::hostile {

/// Numbers that look random and are the same for the same seed on every machine (splitmix64).
class Random {
public:
    explicit Random(std::uint64_t seed) : state_(seed) {}
    /// The numbers of one message: they do not depend on the messages before it.
    Random(std::uint64_t seed, std::uint64_t message)
        : state_(seed * 0x9E3779B97F4A7C15U + message * 0xD1B54A32D192ED03U) {
        next();
    }

    std::uint64_t next() {
        state_ += 0x9E3779B97F4A7C15U;
        auto mixed = state_;
        mixed = (mixed ^ (mixed >> 30U)) * 0xBF58476D1CE4E5B9U;
        mixed = (mixed ^ (mixed >> 27U)) * 0x94D049BB133111EBU;
        return mixed ^ (mixed >> 31U);
    }
    /// Number from 0 to limit - 1; limit > 0.
    std::size_t below(std::size_t limit) { return static_cast<std::size_t>(next() % limit); }
    /// True once in `count` times; never for 0.
    bool oneIn(std::size_t count) { return count != 0 && below(count) == 0; }
    template <typename T, std::size_t Size>
    const T& pick(std::span<const T, Size> choices) {
        return choices[below(choices.size())];
    }
    template <typename Choices>
    auto& pick(Choices& choices) {
        return choices[below(choices.size())];
    }

private:
    std::uint64_t state_;
};

}  // namespace metier::hostile
