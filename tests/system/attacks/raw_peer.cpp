#include "raw_peer.hpp"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cmath>
#include <cstring>
#include <utility>

namespace metier::system_tests {
namespace {

constexpr std::size_t kHeader = 8;  // type, chunk type, size
constexpr std::uint32_t kBuffer = 65535;
constexpr std::uint32_t kBadTimeout = 0x800A0000;
constexpr std::uint32_t kForEver = 3'600'000;  // [ms]
constexpr std::string_view kNone = "http://opcfoundation.org/UA/SecurityPolicy#None";
constexpr std::string_view kAnonymous = "anonymous-none#None";  // the server's name for the policy
// Size of a MSG's begin: header, channel, token, sequence, request, type of the answer.
constexpr std::size_t kResponseHeader = 28;
constexpr std::size_t kServiceResult = kResponseHeader + 12;
constexpr std::size_t kBehindHeader = kServiceResult + 4 + 1 + 4 + 3;

template <typename Number>
Number valueAt(std::string_view bytes, std::size_t at) {
    Number number{};
    if (at + sizeof(number) <= bytes.size()) {
        std::memcpy(&number, bytes.data() + at, sizeof(number));
    }
    return number;
}

/// Size of the NodeId at the begin.
std::size_t nodeIdSize(std::string_view bytes) {
    switch (bytes.empty() ? 0 : bytes.front()) {
        case 0:
            return 2;
        case 1:
            return 4;
        case 2:
            return 7;
        case 4:
            return 19;
        default:
            return 7 + static_cast<std::size_t>(valueAt<std::uint32_t>(bytes, 3));
    }
}

/// As OPC UA counts: 100 ns since 1601.
std::int64_t now() {
    constexpr std::int64_t kUnixEpoch = 116'444'736'000'000'000;
    using Ticks = std::chrono::duration<std::int64_t, std::ratio<1, 10'000'000>>;
    const auto since = std::chrono::system_clock::now().time_since_epoch();
    return kUnixEpoch + std::chrono::duration_cast<Ticks>(since).count();
}

void setTimeouts(int socket, std::chrono::seconds patience) {
    const timeval longest{patience.count(), 0};
    ::setsockopt(socket, SOL_SOCKET, SO_RCVTIMEO, &longest, sizeof(longest));
    ::setsockopt(socket, SOL_SOCKET, SO_SNDTIMEO, &longest, sizeof(longest));
    const int on = 1;
    ::setsockopt(socket, IPPROTO_TCP, TCP_NODELAY, &on, sizeof(on));
}

}  // namespace

WireBytes& WireBytes::text(std::string_view text) {
    put(static_cast<std::int32_t>(text.size()));
    return raw(text);
}

WireBytes& WireBytes::raw(std::string_view bytes) {
    bytes_.append(bytes);
    return *this;
}

WireBytes& WireBytes::node(std::uint16_t number) {
    return put(std::uint16_t{1}).put(number);
}

WireBytes& WireBytes::node(std::uint16_t name_space, std::string_view id) {
    return put(std::uint8_t{3}).put(name_space).text(id);
}

WireBytes sessionOf(std::chrono::milliseconds timeout, std::string_view nonce) {
    WireBytes body;
    body.text("urn:attacker").nothing().put(std::uint8_t{0}).put(std::uint32_t{1});
    body.nothing().nothing().nothing();                       // the rest of the description
    body.nothing().text("opc.tcp://attacked").text("siege");  // server, endpoint, name
    body.text(nonce).nothing().put(static_cast<double>(timeout.count()));
    return body.put(std::uint32_t{0});
}

std::chrono::milliseconds sessionTimeout(const std::string& answer) {
    const auto id = nodeIdSize(answer);
    const auto token = std::string_view(answer).substr(id);
    return std::chrono::milliseconds(std::llround(valueAt<double>(token, nodeIdSize(token))));
}

RawPeer::RawPeer(const std::string& host, std::uint16_t port, int receive_buffer,
                 std::chrono::seconds patience)
    : socket_(::socket(AF_INET, SOCK_STREAM, 0)) {
    if (receive_buffer > 0) {
        ::setsockopt(socket_, SOL_SOCKET, SO_RCVBUF, &receive_buffer, sizeof(receive_buffer));
    }
    setTimeouts(socket_, patience);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(port);
    ::inet_pton(AF_INET, host.c_str(), &address.sin_addr);
    if (::connect(socket_, reinterpret_cast<const sockaddr*>(&address),  // NOLINT
                  sizeof(address)) != 0) {
        hangUp();
    }
}

RawPeer::~RawPeer() {
    hangUp();
}

RawPeer::RawPeer(RawPeer&& other) noexcept {
    *this = std::move(other);
}

RawPeer& RawPeer::operator=(RawPeer&& other) noexcept {
    std::swap(socket_, other.socket_);
    channel_ = other.channel_;
    token_ = other.token_;
    sequence_ = other.sequence_;
    authentication_ = std::move(other.authentication_);
    return *this;
}

void RawPeer::hangUp() {
    if (socket_ >= 0) {
        ::close(std::exchange(socket_, -1));
    }
}

bool RawPeer::hello() {
    WireBytes body;
    body.put(std::uint32_t{0}).put(kBuffer).put(kBuffer);
    body.put(std::uint32_t{0}).put(std::uint32_t{0}).text("opc.tcp://attacked");
    WireBytes message;
    message.raw("HELF").put(static_cast<std::uint32_t>(kHeader + body.str().size()));
    message.raw(body.str());
    const auto answer = send(message.str()) ? receive() : std::nullopt;
    return answer && answer->starts_with("ACK");
}

bool RawPeer::openChannel() {
    WireBytes body;
    body.put(std::uint32_t{0}).put(std::uint32_t{0}).put(std::uint32_t{1});
    body.nothing().put(kForEver);
    const auto answer =
        send(chunk("OPNF", request::kOpenSecureChannel, body)) ? receive() : std::nullopt;
    if (!answer || !answer->starts_with("OPN")) {
        return false;
    }
    channel_ = valueAt<std::uint32_t>(*answer, kHeader);
    // Behind: policy, two null ByteStrings, sequence, request, type, header, version, channel.
    const auto policy = valueAt<std::uint32_t>(*answer, kHeader + 4);
    const auto header = kHeader + 4 + 4 + policy + 8 + 8 + 4;
    token_ = valueAt<std::uint32_t>(*answer, header + (kBehindHeader - kResponseHeader) + 4 + 4);
    return true;
}

bool RawPeer::createSession() {
    const auto answer =
        ask(request::kCreateSession, sessionOf(std::chrono::milliseconds(kForEver)));
    if (!answer) {
        return false;
    }
    const auto id = nodeIdSize(*answer);
    const auto token = std::string_view(*answer).substr(id);
    authentication_ = token.substr(0, nodeIdSize(token));
    return true;
}

bool RawPeer::activateSession() {
    WireBytes body;
    body.nothing().nothing().nothing().nothing();  // signature, ..., locales
    body.node(321).put(std::uint8_t{1}).text(WireBytes().text(kAnonymous).str());
    body.nothing().nothing();
    return ask(request::kActivateSession, body).has_value();
}

bool RawPeer::request(std::uint16_t type, const WireBytes& body) {
    return send(chunk("MSGF", type, body));
}

std::optional<std::string> RawPeer::ask(std::uint16_t type, const WireBytes& body) {
    return statusOf(type, body) == 0 ? std::optional(answer_) : std::nullopt;
}

std::uint32_t RawPeer::statusOf(std::uint16_t type, const WireBytes& body) {
    return request(type, body) ? readStatus() : kBadTimeout;
}

std::uint32_t RawPeer::readStatus() {
    const auto message = receive();
    if (!message) {
        return kBadTimeout;
    }
    if (message->starts_with("ERR")) {
        return valueAt<std::uint32_t>(*message, kHeader);
    }
    answer_ = message->size() < kBehindHeader ? std::string() : message->substr(kBehindHeader);
    return valueAt<std::uint32_t>(*message, kServiceResult);
}

std::uint32_t RawPeer::statusInChunks(std::uint16_t type, const WireBytes& body,
                                      std::size_t chunks) {
    const auto content = headerOf(type) + body.str();
    const auto size = (content.size() + chunks - 1) / chunks;
    const auto number = sequence_ + 1;
    for (std::size_t i = 0; i < chunks; ++i) {
        const bool last = i + 1 == chunks;
        send(chunkOf(last ? "MSGF" : "MSGC", number,
                     std::string_view(content).substr(i * size, size)));
    }
    return readStatus();
}

void RawPeer::closeSession() {
    statusOf(request::kCloseSession, WireBytes().put(std::uint8_t{1}));
}

bool RawPeer::intermediateChunk(std::size_t size) {
    WireBytes message;
    message.raw("MSGC").put(static_cast<std::uint32_t>(size)).put(channel_).put(token_);
    message.put(++sequence_).put(std::uint32_t{1});
    message.raw(std::string(size - message.str().size(), 'x'));
    return send(message.str());
}

bool RawPeer::send(std::string_view bytes) {
    while (connected() && !bytes.empty()) {
        const auto sent = ::send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
        if (sent <= 0) {
            hangUp();
            return false;
        }
        bytes.remove_prefix(static_cast<std::size_t>(sent));
    }
    return connected();
}

std::optional<std::size_t> RawPeer::drain() {
    std::array<char, kBuffer> buffer{};
    std::size_t total = 0;
    while (connected()) {
        const auto size = ::recv(socket_, buffer.data(), buffer.size(), MSG_DONTWAIT);
        if (size < 0 && errno == EAGAIN) {
            return total;
        }
        if (size <= 0) {
            hangUp();
            break;
        }
        total += static_cast<std::size_t>(size);
    }
    return std::nullopt;
}

std::optional<std::size_t> RawPeer::drainSome() {
    char byte = 0;
    const auto size = connected() ? ::recv(socket_, &byte, 1, 0) : 0;
    if (size <= 0) {
        return std::nullopt;
    }
    const auto more = drain();
    return more ? std::optional(*more + 1) : std::nullopt;
}

std::string RawPeer::chunk(std::string_view type, std::uint16_t request, const WireBytes& body) {
    return chunkOf(type, sequence_ + 1, headerOf(request) + body.str());
}

/// The type of a request and its RequestHeader.
std::string RawPeer::headerOf(std::uint16_t request) {
    WireBytes header;
    header.node(request).raw(authentication_).put(now()).put(sequence_ + 1);
    header.put(std::uint32_t{0}).nothing().put(std::uint32_t{0}).put(std::uint16_t{0});
    return header.put(std::uint8_t{0}).str();  // no additional header
}

std::string RawPeer::chunkOf(std::string_view type, std::uint32_t request,
                             std::string_view content) {
    WireBytes header;
    header.put(channel_);
    if (type.starts_with("OPN")) {
        header.text(kNone).nothing().nothing();
    } else {
        header.put(token_);
    }
    header.put(++sequence_).put(request);
    WireBytes message;
    message.raw(type);
    message.put(static_cast<std::uint32_t>(kHeader + header.str().size() + content.size()));
    return message.raw(header.str()).raw(content).str();
}

std::optional<std::string> RawPeer::receive() {
    std::string message(kHeader, '\0');
    if (!fill(message)) {
        return std::nullopt;
    }
    const auto size = valueAt<std::uint32_t>(message, 4);
    if (size < kHeader || size > kBuffer) {
        return std::nullopt;
    }
    std::string rest(size - kHeader, '\0');
    return fill(rest) ? std::optional(message + rest) : std::nullopt;
}

bool RawPeer::fill(std::string& bytes) {
    std::size_t filled = 0;
    while (connected() && filled < bytes.size()) {
        const auto size = ::recv(socket_, bytes.data() + filled, bytes.size() - filled, 0);
        if (size <= 0) {
            hangUp();
            return false;
        }
        filled += static_cast<std::size_t>(size);
    }
    return connected();
}

}  // namespace metier::system_tests
