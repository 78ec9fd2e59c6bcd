#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "web_socket.hpp"

using namespace metier::virtual_edo;

namespace {

constexpr std::string_view kRequest =
    "GET / HTTP/1.1\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
    "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\nSec-WebSocket-Version: 13\r\n\r\n";

}  // namespace

/// The first byte chooses whether the rest is a handshake or frames behind one, in how large parts.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    if (size == 0) {
        return 0;
    }
    WebSocket socket;
    if ((data[0] & 1U) != 0) {
        socket.receive(std::as_bytes(std::span(kRequest)));
    }
    const std::size_t part = 1U + (data[0] >> 1U);
    auto rest = std::as_bytes(std::span(data + 1, size - 1));
    answerHandshake({reinterpret_cast<const char*>(rest.data()), rest.size()});
    while (!rest.empty()) {
        const auto now = rest.first(part < rest.size() ? part : rest.size());
        socket.receive(now);
        rest = rest.subspan(now.size());
    }
    return 0;
}
