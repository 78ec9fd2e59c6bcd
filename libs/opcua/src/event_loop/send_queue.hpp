#pragma once

#include <open62541/types.h>
#include <open62541/types_generated.h>

#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <span>

namespace metier::opcua {

/// A buffer of the stack; freed by the destructor.
class NetworkBuffer {
public:
    /// Takes the memory over: `bytes` is empty afterwards.
    explicit NetworkBuffer(UA_ByteString* bytes)
        : memory_(bytes->data), unsent_(bytes->data, bytes->length) {
        UA_ByteString_init(bytes);
    }

    std::span<const std::uint8_t> unsent() const { return unsent_; }
    void consume(std::size_t sent) { unsent_ = unsent_.subspan(sent); }

private:
    struct Free {
        void operator()(UA_Byte* memory) const {
            UA_Array_delete(memory, 0, &UA_TYPES[UA_TYPES_BYTE]);
        }
    };

    std::unique_ptr<UA_Byte, Free> memory_;
    std::span<const std::uint8_t> unsent_;
};

/// Data that a peer has not read yet.
class SendQueue {
public:
    void push(NetworkBuffer buffer);
    /// The oldest unsent bytes; the queue must not be empty.
    std::span<const std::uint8_t> front() const { return buffers_.front().unsent(); }
    /// Drops the oldest `sent` bytes, at most those of front().
    void consume(std::size_t sent);
    void clear();
    bool empty() const { return buffers_.empty(); }
    std::size_t size() const { return size_; }  ///< [byte]

private:
    std::deque<NetworkBuffer> buffers_;
    std::size_t size_ = 0;
};

}  // namespace metier::opcua
