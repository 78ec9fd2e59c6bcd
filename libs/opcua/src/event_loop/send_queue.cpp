#include "send_queue.hpp"

#include <utility>

namespace metier::opcua {

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
