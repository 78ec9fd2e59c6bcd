#include "web_socket.hpp"

#include <array>
#include <utility>

#include "metier/base/text.hpp"

namespace metier::virtual_edo {
namespace {

enum WebSocketOpcode : std::uint8_t {
    continuation = 0x0,
    text = 0x1,
    binary = 0x2,
    close = 0x8,
    ping = 0x9,
    pong = 0xA,
};

// RFC 6455 section 7.4.1.
constexpr std::uint16_t kProtocolError = 1002;
constexpr std::uint16_t kNotUtf8 = 1007;
constexpr std::uint16_t kTooLong = 1009;

constexpr std::size_t kLongestControl = 125;

std::uint64_t bigEndian(std::string_view bytes) {
    std::uint64_t value = 0;
    for (const char byte : bytes) {
        value = (value << 8) | static_cast<std::uint8_t>(byte);
    }
    return value;
}

std::string frame(std::uint8_t opcode, std::string_view payload) {
    std::string bytes(1, static_cast<char>(0x80U | opcode));
    const auto append = [&](unsigned count) {
        for (unsigned i = count; i-- > 0;) {
            bytes += static_cast<char>((payload.size() >> (8 * i)) & 0xFFU);
        }
    };
    if (payload.size() <= kLongestControl) {
        append(1);
    } else if (payload.size() <= 0xFFFF) {
        bytes += '\x7E';
        append(2);
    } else {
        bytes += '\x7F';
        append(8);
    }
    return bytes.append(payload);
}

/// Status codes that a client may send.
bool isCloseStatus(std::uint64_t status) {
    return (status >= 1000 && status <= 1011 && status != 1004 && status != 1005 &&
            status != 1006) ||
           (status >= 3000 && status <= 4999);
}

/// Header of a frame, known once its first bytes are there.
struct Header {
    std::size_t size = 0;  // with the mask
    std::uint64_t length = 0;
};

/// The header of the frame at the front; size 0 while bytes are missing.
Header headerOf(std::string_view bytes) {
    const std::uint8_t code = static_cast<std::uint8_t>(bytes[1]) & 0x7FU;
    const std::size_t extra = code == 126 ? 2 : (code == 127 ? 8 : 0);
    if (bytes.size() < 2 + extra + 4) {
        return {};
    }
    return {.size = 2 + extra + 4, .length = extra == 0 ? code : bigEndian(bytes.substr(2, extra))};
}

/// Reports whether the first two bytes may begin a frame of a client.
bool isLawful(std::uint8_t first, std::uint8_t second) {
    const std::uint8_t opcode = first & 0x0FU;
    const bool is_control = (opcode & 0x8U) != 0;
    const bool known =
        opcode <= WebSocketOpcode::binary || (is_control && opcode <= WebSocketOpcode::pong);
    const bool masked = (second & 0x80U) != 0;
    const bool reserved = (first & 0x70U) != 0;
    const bool whole = (first & 0x80U) != 0 && (second & 0x7FU) <= kLongestControl;
    return known && masked && !reserved && (!is_control || whole);
}

}  // namespace

std::string WebSocket::textFrame(std::string_view message) {
    return frame(WebSocketOpcode::text, message);
}

WebSocket::Received WebSocket::receive(std::span<const std::byte> bytes) {
    Received received;
    if (state_ == State::closed) {
        return received;
    }
    incoming_.append(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    if (state_ == State::handshake) {
        takeHandshake(received);
    }
    while (state_ == State::open && takeFrame(received)) {
    }
    return received;
}

void WebSocket::takeHandshake(Received& received) {
    constexpr std::string_view kEnd = "\r\n\r\n";
    const auto end = incoming_.find(kEnd);
    if (end == std::string::npos && incoming_.size() <= kLongestRequest) {
        return;
    }
    const auto length = end == std::string::npos ? incoming_.size() : end + kEnd.size();
    const auto answer = answerHandshake(std::string_view(incoming_).substr(0, length));
    received.answer += answer.response;
    if (!answer.accepted) {
        state_ = State::closed;
        received.close = true;
        return;
    }
    incoming_.erase(0, length);
    state_ = State::open;
}

bool WebSocket::takeFrame(Received& received) {
    if (incoming_.size() < 2) {
        return false;
    }
    const auto first = static_cast<std::uint8_t>(incoming_[0]);
    if (!isLawful(first, static_cast<std::uint8_t>(incoming_[1]))) {
        fail(kProtocolError, received);
        return false;
    }
    const Header header = headerOf(incoming_);
    const bool is_control = (first & 0x8U) != 0;
    if (!is_control && header.length > kLongestMessage - message_.size()) {
        fail(kTooLong, received);
        return false;
    }
    if (header.size == 0 || incoming_.size() - header.size < header.length) {
        return false;
    }
    Frame taken{.opcode = static_cast<std::uint8_t>(first & 0x0FU),
                .final = (first & 0x80U) != 0,
                .payload = incoming_.substr(header.size, header.length)};
    for (std::size_t i = 0; i < taken.payload.size(); ++i) {
        taken.payload[i] = static_cast<char>(taken.payload[i] ^ incoming_[header.size - 4 + i % 4]);
    }
    incoming_.erase(0, header.size + header.length);
    if (is_control) {
        onControl(taken, received);
    } else {
        onData(taken, received);
    }
    return true;
}

void WebSocket::onControl(const Frame& taken, Received& received) {
    if (taken.opcode == WebSocketOpcode::ping) {
        received.answer += frame(WebSocketOpcode::pong, taken.payload);
        return;
    }
    if (taken.opcode == WebSocketOpcode::pong) {
        return;
    }
    const std::string_view payload = taken.payload;
    if (!payload.empty() &&
        (payload.size() == 1 || !isCloseStatus(bigEndian(payload.substr(0, 2))) ||
         !isUtf8(payload.substr(2)))) {
        fail(kProtocolError, received);
        return;
    }
    received.answer += frame(WebSocketOpcode::close, payload.substr(0, 2));
    state_ = State::closed;
    received.close = true;
}

void WebSocket::onData(const Frame& taken, Received& received) {
    if ((taken.opcode == WebSocketOpcode::continuation) != fragmented_) {
        fail(kProtocolError, received);
        return;
    }
    message_ += taken.payload;
    fragmented_ = !taken.final;
    if (fragmented_) {
        return;
    }
    if (!isUtf8(message_)) {
        fail(kNotUtf8, received);
        return;
    }
    received.messages.push_back(std::exchange(message_, {}));
}

void WebSocket::fail(std::uint16_t status, Received& received) {
    const std::array code{static_cast<char>(status >> 8), static_cast<char>(status & 0xFFU)};
    received.answer += frame(WebSocketOpcode::close, {code.data(), code.size()});
    received.close = true;
    state_ = State::closed;
    incoming_.clear();
}

}  // namespace metier::virtual_edo
