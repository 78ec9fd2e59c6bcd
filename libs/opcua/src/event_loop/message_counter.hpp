#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "chunk_reader.hpp"

namespace metier::opcua {

/// Counts the service messages of a stream of OPC UA chunks, which may be cut anywhere.
class MessageCounter {
public:
    /// \return how many service messages ("MSG", final or aborted chunk) end within `bytes`.
    ///         A malformed size ends the counting: the stack closes such a connection.
    std::size_t feed(std::span<const std::uint8_t> bytes) {
        std::size_t messages = 0;
        while (!bytes.empty()) {
            bytes = bytes.subspan(chunks_.take(bytes));
            const auto type = chunks_.type();
            messages += chunks_.atEnd() && type.starts_with("MSG") && !type.ends_with('C') ? 1 : 0;
        }
        return messages;
    }

private:
    ChunkReader chunks_;
};

}  // namespace metier::opcua
