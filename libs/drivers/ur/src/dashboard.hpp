#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "metier/base/clock.hpp"
#include "metier/base/error.hpp"
#include "metier/link/tcp_link.hpp"
#include "stream_buffer.hpp"

/// The dashboard server of Universal Robots: what a person does at the pendant, as lines of text.
/// Source of every command and reply: docs/protocols/ur.md#dashboard.
namespace metier::ur_driver::dashboard {

/// The first line of the buffer without its end, as printable() makes it; consumes it. Nothing if
/// it is not complete yet. Errors: invalid_argument if it is longer than 1024 characters.
Result<std::optional<std::string>> takeLine(StreamBuffer& buffer);

/// Errors: device_fault if it is neither "true" nor "false".
Result<bool> parseFlag(std::string_view reply);

/// One connection to the server.
///
/// Threading: one thread.
class Client {
public:
    /// Connects and waits for the greeting.
    /// Errors: connection_lost, timeout, invalid_argument (the peer does not greet like a
    /// dashboard).
    static Result<Client> connect(const std::string& host, std::uint16_t port, SteadyTime deadline);

    /// Sends a command and waits for its one line of reply.
    /// Errors: connection_lost, timeout, invalid_argument.
    Result<std::string> ask(std::string_view command, SteadyTime deadline);
    /// The same as ask(). Errors: also device_fault if the reply does not begin with `expected`.
    Result<void> command(std::string_view command, std::string_view expected, SteadyTime deadline);

private:
    explicit Client(link::TcpLink link);
    Result<std::string> line(SteadyTime deadline);

    link::TcpLink link_;
    StreamBuffer buffer_;
};

}  // namespace metier::ur_driver::dashboard
