#include "dashboard.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <span>
#include <utility>

#include "wire.hpp"

namespace metier::ur_driver::dashboard {

namespace {

constexpr std::size_t kLongestLine = 1024;
constexpr std::string_view kGreeting = "Connected: Universal Robots Dashboard Server";

}  // namespace

Result<std::optional<std::string>> takeLine(StreamBuffer& buffer) {
    const auto bytes = buffer.received();
    const auto end = std::find(bytes.begin(), bytes.end(), std::byte{'\n'});
    const auto length = static_cast<std::size_t>(end - bytes.begin());
    if (length > kLongestLine) {
        return fail(Errc::invalid_argument,
                    fmt::format("a line of more than {} characters", kLongestLine));
    }
    if (end == bytes.end()) {
        return std::nullopt;
    }
    auto line = printable(ByteReader(bytes).text(length));
    buffer.consume(length + 1);
    return line;
}

Result<bool> parseFlag(std::string_view reply) {
    if (reply != "true" && reply != "false") {
        return fail(Errc::device_fault,
                    fmt::format("the dashboard answered \"{}\", neither true nor false", reply));
    }
    return reply == "true";
}

Client::Client(link::TcpLink link) : link_(std::move(link)), buffer_(4 * kLongestLine) {}

Result<Client> Client::connect(const std::string& host, std::uint16_t port, SteadyTime deadline) {
    METIER_ASSIGN(auto link, link::TcpLink::connect(host, port, deadline));
    Client client(std::move(link));
    METIER_ASSIGN(const auto greeting, client.line(deadline));
    if (greeting.substr(0, kGreeting.size()) != kGreeting) {
        return fail(Errc::invalid_argument,
                    fmt::format("{}: no dashboard server: \"{}\"", client.link_.peer(), greeting));
    }
    return client;
}

Result<std::string> Client::ask(std::string_view command, SteadyTime deadline) {
    const std::string line_out = std::string(command) + "\n";
    METIER_TRY(link_.send(std::as_bytes(std::span(line_out)), deadline));
    return line(deadline);
}

Result<void> Client::command(std::string_view command, std::string_view expected,
                             SteadyTime deadline) {
    METIER_ASSIGN(const auto reply, ask(command, deadline));
    if (reply.substr(0, expected.size()) != expected) {
        return fail(Errc::device_fault, fmt::format("\"{}\" was answered with \"{}\", not \"{}\"",
                                                    command, reply, expected));
    }
    return {};
}

Result<std::string> Client::line(SteadyTime deadline) {
    for (;;) {
        auto line = takeLine(buffer_);
        if (!line) {
            return fail(line.error().code, link_.peer() + ": " + line.error().message);
        }
        if (*line) {
            return std::move(**line);
        }
        METIER_ASSIGN(const auto count, link_.receive(buffer_.space(), deadline));
        buffer_.filled(count);
    }
}

}  // namespace metier::ur_driver::dashboard
