#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace metier::virtual_edo {

/// Longest HTTP request that is read.
inline constexpr std::size_t kLongestRequest = 16'384;

/// Answer of a server to the HTTP request for a WebSocket.
struct HandshakeAnswer {
    std::string response;   ///< text to send
    bool accepted = false;  ///< otherwise the connection is to be closed after the response
};

/// The server's side of the opening handshake: no subprotocol, no extension (permessage-deflate is
/// declined by not naming it).
/// \param request the request with its empty line, at most kLongestRequest bytes
/// Source: RFC 6455 section 4.2.
HandshakeAnswer answerHandshake(std::string_view request);

/// The Sec-WebSocket-Accept that belongs to a Sec-WebSocket-Key.
std::string acceptKey(std::string_view key);

}  // namespace metier::virtual_edo
