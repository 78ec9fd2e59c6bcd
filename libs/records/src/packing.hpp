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
    /// Its number; kMost if it is not among them.
    std::uint8_t find(std::string_view text) const;
    const std::string& use(std::uint8_t number);
    const std::string& latest() const { return texts_[latest_]; }
    /// In place of the one that was added first.
    /// \param shared how much of the beginning is as in the latest [byte]
    void add(std::size_t shared, std::string_view rest);
    /// As at first, but for the memory, which is kept.
    void clear();

private:
    std::uint8_t latest_ = 0;
    std::uint8_t next_ = 0;
    std::array<std::uint64_t, kMost> hashes_{};
    std::array<std::string, kMost> texts_;
};

/// What keys and times are told as a difference from.
struct BeforeIntegers {
    std::uint64_t key = 0;
    std::uint64_t time = 0;
};

/// Appends to `bytes`.
class Packer {
public:
    Packer(Bytes& bytes, BeforeIntegers& before) : bytes_(bytes), before_(before) {}

    void byte(std::uint8_t value) { bytes_.push_back(value); }
    void key(Recorder::Key key);
    void put(std::string_view text, RecentTexts& recent);
    void put(UtcTime time);
    void put(std::uint64_t value);

private:
    Bytes& bytes_;
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
