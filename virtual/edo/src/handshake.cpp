#include <fmt/format.h>
#include <openssl/evp.h>

#include <array>
#include <boost/beast/http/empty_body.hpp>
#include <boost/beast/http/parser.hpp>
#include <boost/beast/websocket/rfc6455.hpp>
#include <span>

#include "base64.hpp"
#include "web_socket.hpp"

namespace metier::virtual_edo {
namespace {

namespace http = boost::beast::http;

constexpr std::size_t kNonceSize = 16;

HandshakeAnswer refused(std::string_view status, std::string_view why) {
    return {
        .response = fmt::format("HTTP/1.1 {}\r\nConnection: close\r\nContent-Type: text/plain\r\n"
                                "Sec-WebSocket-Version: 13\r\nContent-Length: {}\r\n\r\n{}",
                                status, why.size(), why),
        .accepted = false};
}

/// The Sec-WebSocket-Accept that belongs to a Sec-WebSocket-Key.
std::string acceptKey(std::string_view key) {
    const auto text = fmt::format("{}258EAFA5-E914-47DA-95CA-C5AB0DC85B11", key);
    std::array<unsigned char, EVP_MAX_MD_SIZE> digest{};
    unsigned int size = 0;
    EVP_Digest(text.data(), text.size(), digest.data(), &size, EVP_sha1(), nullptr);
    return toBase64(std::span(digest).first(size));
}

}  // namespace

HandshakeAnswer answerHandshake(std::string_view request) {
    http::request_parser<http::empty_body> parser;
    parser.header_limit(kLongestRequest);
    boost::system::error_code ignored;
    parser.put(boost::asio::buffer(request.data(), request.size()), ignored);
    const auto& head = parser.get();
    if (!parser.is_header_done() || head.method() != http::verb::get || head.version() < 11) {
        return refused("400 Bad Request", "a WebSocket begins with GET and HTTP/1.1\n");
    }
    if (!boost::beast::websocket::is_upgrade(head)) {
        return refused("400 Bad Request", "Can \"Upgrade\" only to \"WebSocket\".\n");
    }
    if (head[http::field::sec_websocket_version] != "13") {
        return refused("426 Upgrade Required", "only version 13 of WebSocket is spoken\n");
    }
    const std::string key(head[http::field::sec_websocket_key]);
    if (const auto nonce = fromBase64(key); !nonce || nonce->size() != kNonceSize) {
        return refused("400 Bad Request", "Sec-WebSocket-Key is not 16 bytes in base64\n");
    }
    return {.response = fmt::format("HTTP/1.1 101 Switching Protocols\r\nUpgrade: websocket\r\n"
                                    "Connection: Upgrade\r\nSec-WebSocket-Accept: {}\r\n\r\n",
                                    acceptKey(key)),
            .accepted = true};
}

}  // namespace metier::virtual_edo
