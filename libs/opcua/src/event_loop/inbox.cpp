#include "inbox.hpp"

namespace metier::opcua {

void Inbox::push(std::span<const std::uint8_t> bytes) {
    done();
    bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
}

std::span<std::uint8_t> Inbox::take() {
    const auto left = std::span(bytes_).subspan(taken_);
    const auto piece = left.first(chunks_.take(left));
    taken_ += piece.size();
    return piece;
}

void Inbox::done() {
    bytes_.erase(bytes_.begin(), bytes_.begin() + static_cast<std::ptrdiff_t>(taken_));
    taken_ = 0;
    if (bytes_.empty()) {
        bytes_ = {};
    }
}

}  // namespace metier::opcua
