#include "message_counter.hpp"

#include <algorithm>
#include <string_view>

namespace metier::opcua {

std::size_t MessageCounter::feed(std::span<const std::uint8_t> bytes) {
    std::size_t messages = 0;
    while (!bytes.empty() && !malformed_) {
        const bool in_header = header_filled_ < kHeaderSize;
        const auto step =
            std::min(bytes.size(), in_header ? kHeaderSize - header_filled_ : body_left_);
        if (in_header) {
            std::copy_n(bytes.begin(), step, header_.begin() + static_cast<long>(header_filled_));
            header_filled_ += step;
            if (header_filled_ == kHeaderSize) {
                readHeader();
            }
        } else {
            body_left_ -= step;
        }
        bytes = bytes.subspan(step);
        if (header_filled_ == kHeaderSize && body_left_ == 0) {
            messages += ends_message_ ? 1 : 0;
            header_filled_ = 0;
        }
    }
    return messages;
}

void MessageCounter::readHeader() {
    std::size_t size = 0;
    for (std::size_t i = kHeaderSize; i-- > 4;) {
        size = (size << 8U) | header_.at(i);
    }
    malformed_ = size < kHeaderSize;
    body_left_ = malformed_ ? 0 : size - kHeaderSize;
    const bool service = std::equal(header_.begin(), header_.begin() + 3, "MSG");
    ends_message_ = service && !malformed_ && header_[3] != 'C';
}

}  // namespace metier::opcua
