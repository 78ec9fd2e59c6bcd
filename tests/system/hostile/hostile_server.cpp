#include "hostile_server.hpp"

#include <fmt/format.h>

#include <array>
#include <chrono>

#include "reader.hpp"

namespace metier::hostile {

namespace {

using namespace std::chrono_literals;

constexpr std::size_t kHeader = 8;
constexpr std::size_t kSymmetric = 16;
constexpr std::uint32_t kCreateSession = 461;
constexpr std::uint32_t kActivateSession = 467;
constexpr std::uint32_t kGetEndpoints = 428;

}  // namespace

HostileServer::HostileServer(const Character& character)
    : character_(character), thread_([this](const std::stop_token& stop) { run(stop); }) {}

std::string HostileServer::url() const {
    return fmt::format("opc.tcp://127.0.0.1:{}", listener_.port());
}

void HostileServer::run(const std::stop_token& stop) {
    while (!stop.stop_requested()) {
        auto socket = listener_.accept(20ms);
        if (socket.isOpen()) {
            serve(stop, socket);
        }
    }
}

void HostileServer::serve(const std::stop_token& stop, RawSocket& socket) {
    constexpr std::size_t size_offset = 4;
    channel_ = {};
    Bytes received;
    while (!stop.stop_requested() && socket.isOpen()) {
        socket.receive(received, 20ms);
        std::string_view rest(received);
        while (rest.size() >= kHeader) {
            const auto size = Reader(rest.substr(size_offset)).number<std::uint32_t>();
            if (size < kHeader || size > rest.size()) {
                break;
            }
            answer(socket, rest.substr(0, size));
            rest.remove_prefix(size);
        }
        received.erase(0, received.size() - rest.size());
    }
}

void HostileServer::answer(RawSocket& socket, std::string_view chunk) {
    const auto type = chunk.substr(0, 3);
    if (type == "HEL") {
        Random random(character_.seed, answers_++);
        const bool is_wrong = character_.from_the_start && random.oneIn(4);
        socket.send(acknowledge(Writer(random, is_wrong ? 3 : 0)), 100ms);
    } else if (type == "OPN") {
        Reader reader(chunk.substr(kHeader + 4));
        for (int field = 0; field < 3; ++field) {
            reader.text();
        }
        reader.number<std::uint32_t>();
        channel_.request = reader.number<std::uint32_t>() - 1;
        channel_.id = 1;
        channel_.token = 1;
        Random random(character_.seed, answers_++);
        const auto wrong = character_.from_the_start ? character_.wrong_one_in : 0;
        socket.send(openChunk(channel_, respondOpen(Writer(random, wrong), readRequest(reader))),
                    100ms);
    } else if (type == "MSG") {
        Reader reader(chunk.substr(kHeader + 12));
        channel_.request = reader.number<std::uint32_t>() - 1;
        answerRequest(socket, chunk.substr(kHeader + kSymmetric));
    }
}

bool HostileServer::isHonest(const Asked& asked) const {
    const bool is_begin = asked.type == kCreateSession || asked.type == kActivateSession ||
                          asked.type == kGetEndpoints;
    return is_begin && !character_.from_the_start;
}

std::size_t HostileServer::wrongness(const Asked& asked) const {
    return isHonest(asked) ? 0 : character_.wrong_one_in;
}

void HostileServer::answerRequest(RawSocket& socket, std::string_view body) {
    const auto asked = readRequest(Reader(body));
    Random random(character_.seed, answers_++);
    const auto wrong = wrongness(asked);
    if (!isHonest(asked) && random.oneIn(character_.odd_one_in)) {
        return answerOddly(socket, random, asked);
    }
    auto message = respond(Writer(random, wrong), asked, url(), character_.landscape);
    if (wrong != 0 && random.oneIn(10)) {
        damage(random, message);
    }
    socket.send(inMessage(message), 100ms);
}

void HostileServer::answerOddly(RawSocket& socket, Random& random, const Asked& asked) {
    constexpr std::array<std::uint32_t, 5> statuses{0, 0x8001'0000, 0x8025'0000, 0x4000'0000,
                                                    0xFFFF'FFFF};
    switch (random.below(8)) {
        case 0:
            return;  // says nothing
        case 1:
            return socket.send(
                inMessage(serviceFault(Writer(random, 0), asked, random.pick(statuses))), 100ms);
        case 2:
            channel_.request += 1 + static_cast<std::uint32_t>(random.below(5));
            break;
        case 3: {
            const Asked other{.type = static_cast<std::uint32_t>(422 + random.below(430)),
                              .handle = asked.handle,
                              .items = asked.items};
            return socket.send(
                inMessage(respond(Writer(random, 0), other, url(), character_.landscape)), 100ms);
        }
        case 4:
            return socket.send(endlessChunks(channel_), 500ms);
        case 5:
            return socket.reset();
        case 6: {
            Bytes noise(random.below(5'000), '\0');
            damage(random, noise);
            return socket.send(noise, 100ms);
        }
        default:
            channel_.sequence = static_cast<std::uint32_t>(random.next());
    }
    socket.send(inMessage(respond(Writer(random, 0), asked, url(), character_.landscape)), 100ms);
}

Bytes HostileServer::inMessage(std::string_view body) {
    return messageInParts(channel_, body);
}

}  // namespace metier::hostile
