#include "frame.hpp"

#include <algorithm>
#include <array>

#include "payload.hpp"

namespace metier::virtual_wsg50 {

namespace {

constexpr std::array kPreamble{std::byte{0xAA}, std::byte{0xAA}, std::byte{0xAA}};
constexpr std::size_t kHeaderSize = 6;
constexpr std::size_t kChecksumSize = 2;

constexpr std::array<std::uint16_t, 256> makeTable() {
    std::array<std::uint16_t, 256> table{};
    for (std::uint32_t index = 0; index < table.size(); ++index) {
        std::uint32_t rest = index << 8U;
        for (int bit = 0; bit < 8; ++bit) {
            rest = (rest & 0x8000U) != 0 ? (rest << 1U) ^ 0x1021U : rest << 1U;
        }
        table.at(index) = static_cast<std::uint16_t>(rest);
    }
    return table;
}

constexpr auto kTable = makeTable();

}  // namespace

std::uint16_t checksum(std::span<const std::byte> bytes) noexcept {
    std::uint32_t sum = 0xFFFF;
    for (const std::byte byte : bytes) {
        sum = kTable[(sum ^ std::to_integer<std::uint32_t>(byte)) & 0xFFU] ^ sum >> 8U;
    }
    return static_cast<std::uint16_t>(sum);
}

std::vector<std::byte> encode(std::uint8_t id, std::span<const std::byte> payload) {
    PayloadWriter frame;
    frame.raw(kPreamble).u8(id).u16(static_cast<std::uint16_t>(payload.size())).raw(payload);
    return frame.u16(checksum(frame.bytes())).bytes();
}

void FrameReader::feed(std::span<const std::byte> bytes) {
    buffer_.insert(buffer_.end(), bytes.begin(), bytes.end());
}

std::optional<Frame> FrameReader::next() {
    skipToPreamble();
    if (buffer_.size() < kHeaderSize) {
        return std::nullopt;
    }
    PayloadReader header{std::span(buffer_).subspan(kPreamble.size())};
    Frame frame;
    frame.id = header.u8();
    const std::size_t length = header.u16();
    const std::size_t size = kHeaderSize + length + kChecksumSize;
    if (buffer_.size() < size) {
        return std::nullopt;
    }
    const auto end = buffer_.begin() + static_cast<std::ptrdiff_t>(size);
    frame.payload.assign(buffer_.begin() + kHeaderSize, end - kChecksumSize);
    frame.intact = checksum(std::span(buffer_).first(size)) == 0;
    buffer_.erase(buffer_.begin(), end);
    return frame;
}

void FrameReader::skipToPreamble() {
    auto found = std::search(buffer_.begin(), buffer_.end(), kPreamble.begin(), kPreamble.end());
    if (found == buffer_.end()) {
        // The last bytes may be the beginning of a preamble.
        for (std::size_t kept = 1;
             kept < kPreamble.size() && found != buffer_.begin() && *(found - 1) == kPreamble[0];
             ++kept) {
            --found;
        }
    }
    buffer_.erase(buffer_.begin(), found);
}

}  // namespace metier::virtual_wsg50
