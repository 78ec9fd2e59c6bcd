#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

namespace metier::opcua {

/// Divides a stream of OPC UA chunks, which may be cut anywhere, where its chunks end.
///
/// Only the 8 bytes of each chunk's message header are read; they are never encrypted. Data that is
/// not a chunk never ends: the stack closes such a connection.
/// Source: OPC 10000-6, 6.7.2.2 Message Header (MessageType, IsFinal, MessageSize).
class ChunkReader {
public:
    /// Goes on in the stream.
    /// \return how many of `bytes` belong to the present chunk
    std::size_t take(std::span<const std::uint8_t> bytes);
    /// Whether the last take() has reached the end of a chunk.
    bool atEnd() const { return at_end_; }
    /// MessageType and IsFinal of the present chunk, "MSGF"; valid once its header was taken.
    std::string_view type() const;

private:
    static constexpr std::size_t kHeader = 8;

    std::size_t bodySize() const;

    std::array<std::uint8_t, kHeader> header_{};
    std::size_t header_filled_ = 0;
    std::size_t body_left_ = 0;
    bool at_end_ = true;
};

}  // namespace metier::opcua
