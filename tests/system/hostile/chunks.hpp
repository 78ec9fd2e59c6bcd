#pragma once

#include <cstdint>
#include <string_view>

#include "writer.hpp"

namespace metier::hostile {

/// State of a SecureChannel without security, for the frame of a message (OPC 10000-6, 6.7).
struct Channel {
    std::uint32_t id = 0;
    std::uint32_t token = 0;
    std::uint32_t sequence = 0;
    std::uint32_t request = 0;
};

Bytes hello(Writer writer, std::string_view url);
/// OPN, without security.
Bytes openChunk(Channel& channel, std::string_view body);
/// Chunks of a message, MSG or CLO. One in `wrong_one_in` is wrong: type, size, ids, sequence
/// number, chunks that do not end, or too many of them.
Bytes chunks(Random& random, Channel& channel, std::string_view body, std::size_t wrong_one_in);
Bytes closeChunk(Channel& channel, std::string_view body);

/// ACK, as a server sends it.
Bytes acknowledge(Writer writer);
/// MSG without a mistake, in chunks of the size that clients take.
Bytes messageInParts(Channel& channel, std::string_view body);
/// Some megabytes of a message that does not end.
Bytes endlessChunks(Channel& channel);

/// Changes, cuts off or adds bytes.
void damage(Random& random, Bytes& bytes);

}  // namespace metier::hostile
