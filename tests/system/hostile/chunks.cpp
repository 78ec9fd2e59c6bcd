#include "chunks.hpp"

#include <algorithm>
#include <array>

namespace metier::hostile {

namespace {

constexpr std::string_view kNone = "http://opcfoundation.org/UA/SecurityPolicy#None";

struct Framing {
    std::string_view type = "MSG";
    char part = 'F';
    std::int64_t size_lie = 0;
};

void put(Bytes& bytes, std::uint32_t value) {
    for (unsigned shift = 0; shift < 32; shift += 8) {
        bytes.push_back(static_cast<char>(value >> shift));
    }
}

Bytes framed(const Framing& framing, std::string_view content) {
    constexpr std::int64_t header = 8;
    Bytes bytes(framing.type);
    bytes.push_back(framing.part);
    put(bytes, static_cast<std::uint32_t>(static_cast<std::int64_t>(content.size()) + header +
                                          framing.size_lie));
    return bytes.append(content);
}

Bytes symmetric(const Channel& channel, std::string_view body) {
    Bytes content;
    for (const auto field : {channel.id, channel.token, channel.sequence, channel.request}) {
        put(content, field);
    }
    return content.append(body);
}

/// Something else than what was to be sent.
void distort(Random& random, Framing& framing, Channel& channel) {
    constexpr std::array<std::string_view, 7> types{"XYZ", "ERR", "ACK",   "RHE",
                                                    "HEL", "OPN", "\0\0\0"};
    constexpr std::array<char, 5> odd_ends{'C', 'A', 'Z', '\0', '\x7f'};
    constexpr std::array<std::int64_t, 8> lies{-8, -7, -1, 1, 8, 70'000, 2'000'000, 0x7FFF'0000};
    switch (random.below(7)) {
        case 0:
            framing.type = random.pick(types);
            break;
        case 1:
        case 2:
            framing.part = random.pick(odd_ends);
            break;
        case 3:
            framing.size_lie = random.pick(lies);
            break;
        case 4:
            channel.id = static_cast<std::uint32_t>(random.below(10));
            break;
        case 5:
            channel.token = static_cast<std::uint32_t>(random.below(10));
            break;
        default:
            channel.sequence = static_cast<std::uint32_t>(random.next());
    }
}

Bytes inParts(Random& random, Channel& channel, std::string_view body) {
    const std::size_t parts = random.oneIn(20) ? 40 : 2 + random.below(4);
    const auto length = std::max<std::size_t>(1, body.size() / parts);
    Bytes all;
    while (body.size() > length) {
        all += framed({"MSG", 'C'}, symmetric(channel, body.substr(0, length)));
        body.remove_prefix(length);
        ++channel.sequence;
    }
    return all += framed({"MSG", random.oneIn(10) ? 'A' : 'F'}, symmetric(channel, body));
}

}  // namespace

Bytes hello(Writer writer, std::string_view url) {
    constexpr std::uint32_t buffer = 65'535;
    writer.number(std::uint32_t{0});
    writer.number(buffer);
    writer.number(buffer);
    writer.number(std::uint32_t{0});
    writer.number(std::uint32_t{0});
    writer.text(url);
    return framed({"HEL"}, writer.bytes());
}

Bytes openChunk(Channel& channel, std::string_view body) {
    ++channel.sequence;
    ++channel.request;
    Bytes content;
    put(content, channel.id);
    put(content, static_cast<std::uint32_t>(kNone.size()));
    content.append(kNone);
    constexpr std::uint32_t null = 0xFFFF'FFFF;
    for (const auto field : {null, null, channel.sequence, channel.request}) {
        put(content, field);
    }
    return framed({"OPN"}, content.append(body));
}

Bytes chunks(Random& random, Channel& channel, std::string_view body, std::size_t wrong_one_in) {
    ++channel.sequence;
    ++channel.request;
    if (random.oneIn(wrong_one_in)) {
        Framing framing;
        Channel distorted = channel;
        distort(random, framing, distorted);
        return framed(framing, symmetric(distorted, body));
    }
    return random.oneIn(20) ? inParts(random, channel, body) : framed({}, symmetric(channel, body));
}

Bytes closeChunk(Channel& channel, std::string_view body) {
    ++channel.sequence;
    ++channel.request;
    return framed({"CLO"}, symmetric(channel, body));
}

Bytes acknowledge(Writer writer) {
    constexpr std::uint32_t buffer = 65'535;
    writer.number(std::uint32_t{0});
    writer.number(buffer);
    writer.number(buffer);
    writer.number(std::uint32_t{0});
    writer.number(std::uint32_t{0});
    return framed({"ACK"}, writer.bytes());
}

Bytes messageInParts(Channel& channel, std::string_view body) {
    constexpr std::size_t most = 60'000;
    ++channel.request;
    Bytes all;
    for (; body.size() > most; body.remove_prefix(most)) {
        ++channel.sequence;
        all += framed({"MSG", 'C'}, symmetric(channel, body.substr(0, most)));
    }
    ++channel.sequence;
    return all += framed({"MSG", 'F'}, symmetric(channel, body));
}

Bytes endlessChunks(Channel& channel) {
    constexpr int how_many = 80;
    const Bytes body(60'000, 'e');
    ++channel.request;
    Bytes all;
    for (int i = 0; i < how_many; ++i) {
        ++channel.sequence;
        all += framed({"MSG", 'C'}, symmetric(channel, body));
    }
    return all;
}

void damage(Random& random, Bytes& bytes) {
    if (bytes.empty()) {
        return;
    }
    switch (random.below(4)) {
        case 0:
            bytes.resize(random.below(bytes.size()));
            break;
        case 1:
            bytes.insert(random.below(bytes.size()), 1 + random.below(9),
                         static_cast<char>(random.next()));
            break;
        default:
            for (auto changes = 1 + random.below(4); changes > 0; --changes) {
                bytes[random.below(bytes.size())] = static_cast<char>(random.next());
            }
    }
}

}  // namespace metier::hostile
