#include "frame.hpp"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cstring>

#include "crc.hpp"

namespace metier::wsg50_driver {
namespace {

constexpr std::byte kPreamble{0xAA};
constexpr std::size_t kPreambleSize = 3;
constexpr std::size_t kHeaderSize = 6;
constexpr std::size_t kCrcSize = 2;

std::size_t u16At(std::span<const std::byte> bytes, std::size_t offset) noexcept {
    return std::to_integer<std::size_t>(bytes[offset]) |
           std::to_integer<std::size_t>(bytes[offset + 1]) << 8;
}

}  // namespace

Command::Command(CommandId id) noexcept : id_(id) {
    std::fill_n(bytes_.begin(), kPreambleSize, kPreamble);
    bytes_[kPreambleSize] = static_cast<std::byte>(id);
}

Command& Command::u8(std::uint8_t value) noexcept {
    assert(end_ < kHeader + kLargestPayload);
    bytes_[end_++] = std::byte{value};
    return *this;
}

Command& Command::u16(std::uint16_t value) noexcept {
    u8(static_cast<std::uint8_t>(value & 0xFFU));
    return u8(static_cast<std::uint8_t>(value >> 8U));
}

Command& Command::f32(double value) noexcept {
    const auto bits = std::bit_cast<std::uint32_t>(static_cast<float>(value));
    u16(static_cast<std::uint16_t>(bits & 0xFFFFU));
    return u16(static_cast<std::uint16_t>(bits >> 16U));
}

std::span<const std::byte> Command::bytes() noexcept {
    const auto length = end_ - kHeader;
    bytes_[kPreambleSize + 1] = static_cast<std::byte>(length & 0xFFU);
    bytes_[kPreambleSize + 2] = static_cast<std::byte>(length >> 8U);
    const auto check = crc(std::span(bytes_).first(end_));
    bytes_[end_] = static_cast<std::byte>(check & 0xFFU);
    bytes_[end_ + 1] = static_cast<std::byte>(check >> 8U);
    return std::span(bytes_).first(end_ + kCrcSize);
}

std::span<std::byte> FrameReader::space() noexcept {
    if (begin_ > 0) {
        std::memmove(bytes_.data(), bytes_.data() + begin_, end_ - begin_);
        end_ -= begin_;
        begin_ = 0;
    }
    return std::span(bytes_).subspan(end_);
}

void FrameReader::received(std::size_t count) noexcept {
    end_ = std::min(end_ + count, bytes_.size());
}

std::optional<Frame> FrameReader::next() noexcept {
    for (;;) {
        switch (look()) {
            case Found::frame: {
                const auto frame = std::span(bytes_).subspan(begin_);
                const auto length = u16At(frame, kPreambleSize + 1);
                begin_ += kHeaderSize + length + kCrcSize;
                return Frame{std::to_integer<std::uint8_t>(frame[kPreambleSize]),
                             frame.subspan(kHeaderSize, length)};
            }
            case Found::more:
                return std::nullopt;
            case Found::nothing:
                ++begin_;
        }
    }
}

/// Examines the bytes at begin_.
FrameReader::Found FrameReader::look() noexcept {
    const auto bytes = std::span(bytes_).subspan(begin_, end_ - begin_);
    const auto preamble = bytes.first(std::min(bytes.size(), kPreambleSize));
    if (std::any_of(preamble.begin(), preamble.end(), [](auto b) { return b != kPreamble; })) {
        return Found::nothing;
    }
    if (bytes.size() < kHeaderSize) {
        return Found::more;
    }
    const auto length = u16At(bytes, kPreambleSize + 1);
    if (length > kLargestPayload) {
        return Found::nothing;
    }
    const auto whole = kHeaderSize + length + kCrcSize;
    if (bytes.size() < whole) {
        return Found::more;
    }
    return crc(bytes.first(whole)) == 0 ? Found::frame : Found::nothing;
}

}  // namespace metier::wsg50_driver
