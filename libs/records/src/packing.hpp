#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "database.hpp"
#include "metier/base/clock.hpp"
#include "metier/records/recorder.hpp"

namespace metier::records {

/// The last different texts at one place of a message. Who packs and who unpacks keep the same.
class RecentTexts {
public:
    static constexpr std::uint8_t kMost = 8;

    RecentTexts() { clear(); }
    static std::uint32_t hashOf(std::string_view text);
    /// Its number; kMost if it is not among them.
    /// \param hash of the text
    std::uint8_t find(std::string_view text, std::uint32_t hash) const;
    const std::string& use(std::uint8_t number);
    std::uint8_t latestNumber() const { return latest_; }
    const std::string& latest() const { return texts_[latest_]; }
    /// In place of the one that was added first.
    /// \param hash of the text
    void add(std::string_view text, std::uint32_t hash);
    /// As at first, but for the memory, which is kept.
    void clear();

private:
    // What is looked at each time is in one cache line.
    alignas(64) std::array<std::uint32_t, kMost> hashes_{};
    std::uint8_t latest_ = 0;
    std::uint8_t next_ = 0;
    std::array<std::string, kMost> texts_;
};

/// What keys and times are told as a difference from.
struct BeforeIntegers {
    std::uint64_t key = 0;
    std::uint64_t time = 0;
};

/// Packs into memory that has room for the most that everything may take.
class Packer {
public:
    /// An integer takes so much at most [byte].
    static constexpr std::size_t kMostOfInteger = 10;
    static constexpr std::size_t mostOf(std::string_view text) {
        return 1 + 2 * kMostOfInteger + text.size();
    }

    Packer(std::uint8_t* room, BeforeIntegers& before) : at_(room), before_(before) {}

    void byte(std::uint8_t value) { *at_++ = value; }
    void key(Recorder::Key key);
    void put(std::string_view text, RecentTexts& recent);
    void put(UtcTime time);
    void put(std::uint64_t value);
    /// Of what was packed.
    const std::uint8_t* end() const { return at_; }

private:
    std::uint8_t* at_;
    BeforeIntegers& before_;
};

/// Takes from the front of bytes that may be anything.
class Unpacker {
public:
    Unpacker(std::span<const std::uint8_t> bytes, BeforeIntegers& before)
        : bytes_(bytes), before_(before) {}

    bool isAtEnd() const { return bytes_.empty(); }
    /// Whether all that was asked for was there; what was not is 0 and empty.
    bool isWhole() const { return whole_; }

    std::uint8_t byte();
    Recorder::Key key();
    void take(std::string& text, RecentTexts& recent);
    void take(UtcTime& time);
    void take(std::uint64_t& value) { value = integer(); }

private:
    std::uint64_t integer();
    std::span<const std::uint8_t> next(std::uint64_t size);

    std::span<const std::uint8_t> bytes_;
    BeforeIntegers& before_;
    bool whole_ = true;
};

}  // namespace metier::records
