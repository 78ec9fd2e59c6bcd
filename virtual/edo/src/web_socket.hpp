#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

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

/// Longest message that is taken, in one frame or in many.
inline constexpr std::size_t kLongestMessage = 1'000'000;

/// The server's end of one WebSocket: takes bytes, gives messages and the bytes to answer with. It
/// has no socket.
///
/// Extensions and subprotocols are declined, messages are text (binary ones are taken as text, as
/// rosbridge does). What breaks the protocol closes the connection with the status code of RFC
/// 6455.
///
/// Threading: one thread.
class WebSocket {
public:
    struct Received {
        std::vector<std::string> messages;  ///< whole ones, in order
        std::string answer;                 ///< bytes to send, perhaps none
        bool close = false;                 ///< the connection must be closed after the answer
    };

    /// Takes the bytes of one read. After `close` it takes nothing more.
    Received receive(std::span<const std::byte> bytes);

    /// Reports whether the handshake is done, so that messages may be sent.
    bool isOpen() const noexcept { return state_ == State::open; }

    /// One frame with a text message.
    static std::string textFrame(std::string_view message);

private:
    enum class State : std::uint8_t { handshake, open, closed };
    struct Frame {
        std::uint8_t opcode = 0;
        bool final = false;
        std::string payload;
    };

    void takeHandshake(Received& received);
    bool takeFrame(Received& received);
    void onControl(const Frame& taken, Received& received);
    void onData(const Frame& taken, Received& received);
    void fail(std::uint16_t status, Received& received);

    State state_ = State::handshake;
    std::string incoming_;
    std::string message_;      // fragments so far
    bool fragmented_ = false;  // a message has begun and not ended
};

}  // namespace metier::virtual_edo
