#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace metier::opcua {

/// Checks a server's messages before the stack gets them.
///
/// The stack (1.4) frees a response that it never filled if it cannot decode the NodeId with which
/// the message begins. Without security this can be seen here: each message must begin with a
/// numeric NodeId that is complete within its first chunk. Messages of a channel that is signed or
/// encrypted pass, since they come from a trusted server.
/// Source: OPC 10000-6, 5.2.2.9 NodeId, 6.7.2 MessageChunk structure.
class ResponseGate {
public:
    /// Takes a stream that may be cut anywhere.
    /// \return false if the stack must not see it: then, and ever after
    bool feed(std::span<const std::uint8_t> bytes);

private:
    static constexpr std::size_t kSeen = 80;  // [byte] of each chunk, more than is looked at

    bool take(std::uint8_t byte);
    /// Begins with the header of a chunk.
    bool judge() const;
    bool beginsWithAnId() const;
    void noteSecurity();
    std::uint32_t number(std::size_t at) const;

    std::array<std::uint8_t, kSeen> seen_{};
    std::size_t taken_ = 0;  // [byte] of this chunk
    std::size_t size_ = 0;   // [byte] of this chunk; 0: not known yet
    bool open_ = true;       // the channel's content is not encrypted
    bool goes_on_ = false;   // the chunk before did not end its message
    bool refused_ = false;
};

}  // namespace metier::opcua
