#include "payload.hpp"

#include <algorithm>
#include <bit>

namespace metier::virtual_wsg50 {

PayloadWriter& PayloadWriter::f32(double value) {
    return u32(std::bit_cast<std::uint32_t>(static_cast<float>(value)));
}

PayloadWriter& PayloadWriter::raw(std::span<const std::byte> bytes) {
    bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
    return *this;
}

PayloadWriter& PayloadWriter::number(std::uint32_t value, int size) {
    for (int i = 0; i < size; ++i) {
        bytes_.push_back(static_cast<std::byte>(value & 0xFFU));
        value >>= 8U;
    }
    return *this;
}

double PayloadReader::f32() noexcept {
    return std::bit_cast<float>(number(4));
}

std::uint32_t PayloadReader::number(std::size_t size) noexcept {
    const auto taken = bytes_.first(std::min(size, bytes_.size()));
    bytes_ = bytes_.subspan(taken.size());
    std::uint32_t value = 0;
    std::uint32_t shift = 0;
    for (const std::byte byte : taken) {
        value |= std::to_integer<std::uint32_t>(byte) << shift;
        shift += 8;
    }
    return value;
}

}  // namespace metier::virtual_wsg50
