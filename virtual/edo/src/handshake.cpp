#include "metier/virtual_edo/handshake.hpp"

#include <algorithm>
#include <cctype>
#include <optional>

#include "metier/virtual_edo/base64.hpp"
#include "metier/virtual_edo/sha1.hpp"

namespace metier::virtual_edo {
namespace {

char lower(char character) {
    return static_cast<char>(std::tolower(static_cast<unsigned char>(character)));
}

bool equalIgnoringCase(std::string_view a, std::string_view b) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                      [](char left, char right) { return lower(left) == lower(right); });
}

std::string_view trimmed(std::string_view text) {
    const auto first = text.find_first_not_of(" \t");
    if (first == std::string_view::npos) {
        return {};
    }
    return text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

/// Takes what stands before the separator off the front of `text`; all of it if there is none.
std::string_view takeUntil(std::string_view& text, std::string_view separator) {
    const auto end = text.find(separator);
    const auto part = text.substr(0, end);
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + separator.size());
    return part;
}

/// The value of a header, those of several with the same name joined by commas.
std::optional<std::string> header(std::string_view request, std::string_view name) {
    std::optional<std::string> value;
    takeUntil(request, "\r\n");
    while (!request.empty()) {
        auto line = takeUntil(request, "\r\n");
        if (equalIgnoringCase(trimmed(takeUntil(line, ":")), name)) {
            value = (value ? *value + "," : "") + std::string(trimmed(line));
        }
    }
    return value;
}

bool hasToken(const std::optional<std::string>& list, std::string_view token) {
    std::string_view left = list ? std::string_view(*list) : std::string_view();
    while (!left.empty()) {
        if (equalIgnoringCase(trimmed(takeUntil(left, ",")), token)) {
            return true;
        }
    }
    return false;
}

bool isHttpGet(std::string_view request) {
    auto line = takeUntil(request, "\r\n");
    return takeUntil(line, " ") == "GET" && !takeUntil(line, " ").empty() &&
           line.starts_with("HTTP/1.") && line != "HTTP/1.0";
}

HandshakeAnswer refused(std::string_view status, std::string_view why) {
    std::string response = "HTTP/1.1 ";
    response.append(status).append("\r\nConnection: close\r\nContent-Type: text/plain\r\n");
    response.append("Sec-WebSocket-Version: 13\r\nContent-Length: ");
    response.append(std::to_string(why.size())).append("\r\n\r\n").append(why);
    return {.response = std::move(response), .accepted = false};
}

}  // namespace

std::string acceptKey(std::string_view key) {
    return toBase64(sha1(std::string(key) + "258EAFA5-E914-47DA-95CA-C5AB0DC85B11"));
}

HandshakeAnswer answerHandshake(std::string_view request) {
    if (!isHttpGet(request)) {
        return refused("400 Bad Request", "a WebSocket begins with GET and HTTP/1.1\n");
    }
    if (!hasToken(header(request, "Upgrade"), "websocket") ||
        !hasToken(header(request, "Connection"), "upgrade")) {
        return refused("400 Bad Request", "Can \"Upgrade\" only to \"WebSocket\".\n");
    }
    if (header(request, "Sec-WebSocket-Version") != "13") {
        return refused("426 Upgrade Required", "only version 13 of WebSocket is spoken\n");
    }
    const auto key = header(request, "Sec-WebSocket-Key");
    const auto nonce = key ? fromBase64(*key) : std::nullopt;
    if (!nonce || nonce->size() != 16) {
        return refused("400 Bad Request", "Sec-WebSocket-Key is not 16 bytes in base64\n");
    }
    return {.response =
                "HTTP/1.1 101 Switching Protocols\r\nUpgrade: websocket\r\n"
                "Connection: Upgrade\r\nSec-WebSocket-Accept: " +
                acceptKey(*key) + "\r\n\r\n",
            .accepted = true};
}

}  // namespace metier::virtual_edo
