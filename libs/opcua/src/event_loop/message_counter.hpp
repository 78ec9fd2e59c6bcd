#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace metier::opcua {

/// Counts the service messages of a stream of OPC UA chunks, which may be cut anywhere.
///
/// Only the 8 bytes of each chunk's message header are read; they are never encrypted.
/// Source: OPC 10000-6, 6.7.2.2 Message Header (MessageType, IsFinal, MessageSize).
class MessageCounter {
public:
    /// \return how many service messages ("MSG", final or aborted chunk) end within `bytes`.
    ///         A malformed size ends the counting: the stack closes such a connection.
    std::size_t feed(std::span<const std::uint8_t> bytes);

private:
    static constexpr std::size_t kHeaderSize = 8;

    void readHeader();

    std::array<std::uint8_t, kHeaderSize> header_{};
    std::size_t header_filled_ = 0;
    std::size_t body_left_ = 0;
    bool ends_message_ = false;
    bool malformed_ = false;
};

}  // namespace metier::opcua
