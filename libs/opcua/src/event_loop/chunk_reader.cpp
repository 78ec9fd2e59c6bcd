#include "chunk_reader.hpp"

#include <algorithm>
#include <limits>

namespace metier::opcua {

std::size_t ChunkReader::take(std::span<const std::uint8_t> bytes) {
    header_filled_ = at_end_ ? 0 : header_filled_;
    const auto of_header = std::min(bytes.size(), kHeader - header_filled_);
    std::copy_n(bytes.begin(), of_header,
                header_.begin() + static_cast<std::ptrdiff_t>(header_filled_));
    header_filled_ += of_header;
    if (of_header > 0 && header_filled_ == kHeader) {
        body_left_ = bodySize();
    }
    const bool in_body = header_filled_ == kHeader;
    const auto of_body = in_body ? std::min(bytes.size() - of_header, body_left_) : 0;
    body_left_ -= of_body;
    at_end_ = in_body && body_left_ == 0;
    return of_header + of_body;
}

std::size_t ChunkReader::bodySize() const {
    constexpr std::size_t kSizeOffset = 4;
    std::size_t size = 0;
    for (std::size_t i = kHeader; i-- > kSizeOffset;) {
        size = size << 8U | header_.at(i);
    }
    return size < kHeader ? std::numeric_limits<std::size_t>::max() : size - kHeader;
}

std::string_view ChunkReader::type() const {
    return {reinterpret_cast<const char*>(header_.data()), 4};
}

}  // namespace metier::opcua
