#pragma once

#include <open62541/types.h>

#include <cstddef>
#include <cstdint>
#include <deque>
#include <span>

namespace metier::opcua {

/// A buffer of the stack; freed by the destructor.
class NetworkBuffer {
public:
    /// Takes the memory over: `bytes` is empty afterwards.
    explicit NetworkBuffer(UA_ByteString* bytes);
    NetworkBuffer(NetworkBuffer&& other) noexcept;
    NetworkBuffer& operator=(NetworkBuffer&& other) noexcept;
    NetworkBuffer(const NetworkBuffer&) = delete;
    NetworkBuffer& operator=(const NetworkBuffer&) = delete;
    ~NetworkBuffer();

    std::span<const std::uint8_t> unsent() const;
    void consume(std::size_t sent) { sent_ += sent; }

private:
    UA_ByteString bytes_{};
    std::size_t sent_ = 0;
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
