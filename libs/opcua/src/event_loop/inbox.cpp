#include "inbox.hpp"

#include <algorithm>
#include <limits>

namespace metier::opcua {

void Inbox::push(std::span<const std::uint8_t> bytes) {
    done();
    bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
}

std::span<std::uint8_t> Inbox::take() {
    const auto piece = std::span(bytes_).subspan(taken_, sizeOfNext());
    taken_ += piece.size();
    return piece;
}

std::size_t Inbox::sizeOfNext() {
    const auto left = std::span(bytes_).subspan(taken_);
    const auto of_header = std::min(left.size(), kHeader - header_filled_);
    std::copy_n(left.begin(), of_header,
                header_.begin() + static_cast<std::ptrdiff_t>(header_filled_));
    header_filled_ += of_header;
    if (header_filled_ < kHeader) {
        return of_header;
    }
    if (of_header > 0) {
        body_left_ = bodySize();
    }
    const auto of_body = std::min(left.size() - of_header, body_left_);
    body_left_ -= of_body;
    header_filled_ = body_left_ == 0 ? 0 : header_filled_;
    return of_header + of_body;
}

/// Size of the chunk's body. Data that is not a chunk never ends: the stack closes such a
/// connection.
std::size_t Inbox::bodySize() const {
    std::size_t size = 0;
    for (std::size_t i = kHeader; i > kHeader - 4; --i) {
        size = size << 8U | header_.at(i - 1);
    }
    return size < kHeader ? std::numeric_limits<std::size_t>::max() : size - kHeader;
}

void Inbox::done() {
    bytes_.erase(bytes_.begin(), bytes_.begin() + static_cast<std::ptrdiff_t>(taken_));
    taken_ = 0;
    if (bytes_.empty()) {
        bytes_ = {};
    }
}

}  // namespace metier::opcua
