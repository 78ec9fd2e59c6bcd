#pragma once

#include <array>
#include <cstdint>
#include <string_view>

namespace metier::virtual_edo {

/// SHA-1 (RFC 3174), which the handshake of a WebSocket needs and nothing else should.
std::array<std::uint8_t, 20> sha1(std::string_view text);

}  // namespace metier::virtual_edo
