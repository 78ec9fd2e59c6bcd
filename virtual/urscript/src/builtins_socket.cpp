#include <cstdint>
#include <functional>
#include <limits>

#include "call.hpp"
#include "socket_reading.hpp"

namespace metier::urscript {
namespace {

constexpr const char* kDefaultName = "socket_0";
constexpr double kOpenTimeout = 2.0;  // [s]
constexpr double kReadTimeout = 2.0;  // [s]
constexpr int kMostReadValues = 30;

using Extract = std::function<std::optional<Extracted>(std::string_view bytes)>;

/// One read of a script that waits for what `extract` finds.
struct Reading {
    std::string socket;
    double timeout = kReadTimeout;  // [s]; 0 or less: none
    Extract extract;
    Value otherwise;  // after the time-out, or if the socket is not open
};

std::optional<Value> tryRead(Sockets& sockets, const Reading& reading) {
    auto extracted = reading.extract(sockets.received(reading.socket));
    if (!extracted) {
        return std::nullopt;
    }
    sockets.consume(reading.socket, extracted->used);
    return std::move(extracted->value);
}

// A read that fails takes at least one cycle, so a loop of failed reads is no infinite loop.
Value readFrom(Call& call, Reading reading) {
    if (!call.ok()) {
        return {};
    }
    Sockets& sockets = call.robot().sockets();
    if (auto value = tryRead(sockets, reading)) {
        return *std::move(value);
    }
    const std::int64_t cycles = reading.timeout > 0.0
                                    ? cyclesOf(reading.timeout, call.robot().stepTime())
                                    : std::numeric_limits<std::int64_t>::max();
    return call.waits([&sockets, reading = std::move(reading),
                       cycles = cycles]() mutable -> Result<std::optional<Value>> {
        if (auto value = tryRead(sockets, reading)) {
            return value;
        }
        --cycles;
        const bool over = cycles <= 0 || sockets.state(reading.socket) != SocketState::open;
        return over ? std::optional(reading.otherwise) : std::nullopt;
    });
}

Value open(Call& call) {
    const std::string host = call.string(0);
    const int port = call.integer(1);
    const std::string name = call.string(2, kDefaultName);
    if (!call.ok()) {
        return {};
    }
    constexpr int kMostPort = 65535;
    if (port < 1 || port > kMostPort) {
        return call.failed(Errc::out_of_range,
                           "port " + std::to_string(port) + " is not from 1 to 65535");
    }
    Sockets& sockets = call.robot().sockets();
    sockets.open(name, host, port);
    return call.waits(
        [&sockets, name, cycles = cyclesOf(kOpenTimeout, call.robot().stepTime())]() mutable
        -> Result<std::optional<Value>> {
            --cycles;
            const SocketState state = sockets.state(name);
            if (state == SocketState::opening && cycles > 0) {
                return std::nullopt;
            }
            if (state == SocketState::opening) {
                sockets.close(name);
            }
            return Value(state == SocketState::open);
        });
}

Value close(Call& call) {
    const std::string name = call.string(0, kDefaultName);
    if (call.ok()) {
        call.robot().sockets().close(name);
    }
    return {};
}

/// Reads for the arguments `number socket_name timeout`.
Value readNumbers(Call& call, const Value& failed,
                  std::optional<Extracted> (*extract)(std::string_view, std::size_t)) {
    const int count = call.integer(0);
    if (count < 1 || count > kMostReadValues) {
        return call.failed(Errc::out_of_range,
                           "number " + std::to_string(count) + " is not from 1 to 30");
    }
    const auto size = static_cast<std::size_t>(count);
    return readFrom(call, {call.string(1, kDefaultName), call.number(2, kReadTimeout),
                           [=](std::string_view bytes) { return extract(bytes, size); },
                           failedRead(size, failed)});
}

Value readIntegers(Call& call) {
    return readNumbers(call, -1, [](std::string_view bytes, std::size_t count) {
        return extractIntegers(bytes, count, sizeof(std::int32_t));
    });
}

Value readBytes(Call& call) {
    return readNumbers(call, -1, [](std::string_view bytes, std::size_t count) {
        return extractIntegers(bytes, count, 1);
    });
}

Value readFloats(Call& call) {
    return readNumbers(call, std::numeric_limits<double>::quiet_NaN(), extractFloats);
}

Value readLine(Call& call) {
    return readFrom(
        call, {call.string(0, kDefaultName), call.number(1, kReadTimeout), extractLine, Value("")});
}

Value readText(Call& call) {
    std::string prefix = call.string(1, "");
    std::string suffix = call.string(2, "");
    if (call.boolean(3, false)) {
        prefix = unescaped(prefix);
        suffix = unescaped(suffix);
    }
    return readFrom(call, {call.string(0, kDefaultName), call.number(4, kReadTimeout),
                           [prefix, suffix](std::string_view bytes) {
                               return extractText(bytes, prefix, suffix);
                           },
                           Value("")});
}

Value sendTo(Call& call, std::size_t name, std::string_view bytes) {
    const std::string socket = call.string(name, kDefaultName);
    return call.ok() ? Value(call.robot().sockets().send(socket, bytes)) : Value();
}

Value sendInteger(Call& call) {
    const auto number = static_cast<std::uint32_t>(call.integer(0));
    std::string bytes;
    for (const unsigned shift : {24U, 16U, 8U, 0U}) {
        bytes += static_cast<char>(number >> shift & 0xFFU);
    }
    return sendTo(call, 1, bytes);
}

Value sendByte(Call& call) {
    const std::string byte(1, static_cast<char>(call.integer(0) & 0xFF));
    return sendTo(call, 1, byte);
}

Value getVariable(Call& call) {
    const std::string name = call.string(0);
    sendTo(call, 1, "GET " + name + "\n");
    return readFrom(
        call, {call.string(1, kDefaultName), kReadTimeout,
               [name](std::string_view bytes) { return extractVariable(bytes, name); }, Value(0)});
}

Value setVariable(Call& call) {
    return sendTo(call, 2, "SET " + call.string(0) + " " + std::to_string(call.integer(1)) + "\n");
}

}  // namespace

std::span<const Builtin> socketBuiltins() {
    static constexpr Builtin kAll[] = {
        {"socket_close", "socket_name", 0, close},
        {"socket_get_var", "name socket_name", 1, getVariable},
        {"socket_open", "address port socket_name", 2, open},
        {"socket_read_ascii_float", "number socket_name timeout", 1, readFloats},
        {"socket_read_binary_integer", "number socket_name timeout", 1, readIntegers},
        {"socket_read_byte_list", "number socket_name timeout", 1, readBytes},
        {"socket_read_line", "socket_name timeout", 0, readLine},
        {"socket_read_string", "socket_name prefix suffix interpret_escape timeout", 0, readText},
        {"socket_send_byte", "value socket_name", 1, sendByte},
        {"socket_send_int", "value socket_name", 1, sendInteger},
        {"socket_send_line", "str socket_name", 1,
         [](Call& call) { return sendTo(call, 1, call.value(0).text() + "\n"); }},
        {"socket_send_string", "str socket_name", 1,
         [](Call& call) { return sendTo(call, 1, call.value(0).text()); }},
        {"socket_set_var", "name value socket_name", 2, setVariable},
    };
    return kAll;
}

}  // namespace metier::urscript
