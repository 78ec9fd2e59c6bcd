#include "send_queue.hpp"

#include <utility>

namespace metier::opcua {

NetworkBuffer::NetworkBuffer(UA_ByteString* bytes) : bytes_(*bytes) {
    UA_ByteString_init(bytes);
}

NetworkBuffer::NetworkBuffer(NetworkBuffer&& other) noexcept
    : bytes_(std::exchange(other.bytes_, UA_ByteString{})), sent_(other.sent_) {}

NetworkBuffer& NetworkBuffer::operator=(NetworkBuffer&& other) noexcept {
    std::swap(bytes_, other.bytes_);
    std::swap(sent_, other.sent_);
    return *this;
}

NetworkBuffer::~NetworkBuffer() {
    UA_ByteString_clear(&bytes_);
}

std::span<const std::uint8_t> NetworkBuffer::unsent() const {
    return std::span<const std::uint8_t>(bytes_.data, bytes_.length).subspan(sent_);
}

void SendQueue::push(NetworkBuffer buffer) {
    size_ += buffer.unsent().size();
    buffers_.push_back(std::move(buffer));
}

void SendQueue::consume(std::size_t sent) {
    buffers_.front().consume(sent);
    size_ -= sent;
    if (buffers_.front().unsent().empty()) {
        buffers_.pop_front();
    }
}

void SendQueue::clear() {
    buffers_.clear();
    size_ = 0;
}

}  // namespace metier::opcua
