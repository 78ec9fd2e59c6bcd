#include "web_socket.hpp"

#include <gmock/gmock.h>

#include "base64.hpp"

namespace metier::virtual_edo {
namespace {

using namespace std::string_literals;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;

std::span<const std::byte> bytesOf(const std::string& text) {
    return std::as_bytes(std::span(text));
}

/// A handshake as autobahn sends it.
std::string request(const std::string& extra = "") {
    return "GET / HTTP/1.1\r\nUser-Agent: AutobahnPython/20.12.3\r\nHost: 10.42.0.49:9090\r\n"
           "Upgrade: WebSocket\r\nConnection: Upgrade\r\nPragma: no-cache\r\n"
           "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\nSec-WebSocket-Version: 13\r\n" +
           extra + "\r\n";
}

/// A client's frame: masked.
std::string frame(std::uint8_t first, const std::string& payload) {
    std::string bytes(1, static_cast<char>(first));
    if (payload.size() < 126) {
        bytes += static_cast<char>(0x80U | payload.size());
    } else if (payload.size() <= 0xFFFF) {
        bytes += '\xFE';
        bytes += static_cast<char>(payload.size() >> 8);
        bytes += static_cast<char>(payload.size());
    } else {
        bytes += '\xFF';
        for (int shift = 56; shift >= 0; shift -= 8) {
            bytes += static_cast<char>((std::uint64_t{payload.size()} >> shift) & 0xFFU);
        }
    }
    const std::string mask = "\x37\xfa\x21\x3d";
    bytes += mask;
    for (std::size_t i = 0; i < payload.size(); ++i) {
        bytes += static_cast<char>(payload[i] ^ mask[i % 4]);
    }
    return bytes;
}

std::string closing(std::uint16_t status) {
    return "\x88\x02"s + static_cast<char>(status >> 8) + static_cast<char>(status & 0xFFU);
}

WebSocket openSocket() {
    WebSocket socket;
    socket.receive(bytesOf(request()));
    return socket;
}

TEST(Base64, GoesThereAndBack) {
    EXPECT_EQ(toBase64(std::vector<std::uint8_t>{}), "");
    EXPECT_EQ(toBase64(std::vector<std::uint8_t>{'f', 'o'}), "Zm8=");
    EXPECT_EQ(fromBase64("Zm8=").value(), (std::vector<std::uint8_t>{'f', 'o'}));
    EXPECT_EQ(fromBase64("Zg==").value(), (std::vector<std::uint8_t>{'f'}));
    EXPECT_FALSE(fromBase64("Zm8"));
    for (const auto* broken : {"Z=8=", "Z===", "====", "Zm8!", "Zm 8", " Zm8", "Zm8=\n", "Zm8v\n",
                               "\nZm8", "    Zm8=", "Zm8=    "}) {
        EXPECT_FALSE(fromBase64(broken)) << '"' << broken << '"';
    }
    EXPECT_TRUE(fromBase64("").value().empty());
}

TEST(Handshake, AnswersTheKeyOfTheRfc) {
    WebSocket socket;
    const auto received = socket.receive(bytesOf(request()));
    EXPECT_TRUE(socket.isOpen());
    EXPECT_FALSE(received.close);
    EXPECT_EQ(received.answer,
              "HTTP/1.1 101 Switching Protocols\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
              "Sec-WebSocket-Accept: s3pPLMBiTxaQ9kYGzzhZRbK+xOo=\r\n\r\n");
}

TEST(Handshake, TakesTheRequestByteByByte) {
    WebSocket socket;
    std::string answer;
    for (const char byte : request() + frame(0x81, "{}")) {
        const auto received = socket.receive(bytesOf(std::string(1, byte)));
        answer += received.answer;
        if (!received.messages.empty()) {
            EXPECT_THAT(received.messages, ElementsAre("{}"));
        }
    }
    EXPECT_THAT(answer, StartsWith("HTTP/1.1 101"));
}

TEST(Handshake, DeclinesExtensionsAndSubprotocols) {
    const auto answer = answerHandshake(
        request("Sec-WebSocket-Extensions: permessage-deflate; client_max_window_bits\r\n"
                "Sec-WebSocket-Protocol: rosbridge\r\n"));
    EXPECT_TRUE(answer.accepted);
    EXPECT_THAT(answer.response, Not(HasSubstr("Sec-WebSocket-Extensions")));
    EXPECT_THAT(answer.response, Not(HasSubstr("Sec-WebSocket-Protocol")));
}

TEST(Handshake, TakesListsOfTokensInAnyCase) {
    EXPECT_TRUE(answerHandshake("GET /?x=1 HTTP/1.1\r\nhost: a\r\nUPGRADE: foo, websocket\r\n"
                                "connection: keep-alive, Upgrade\r\n"
                                "sec-websocket-key: dGhlIHNhbXBsZSBub25jZQ==\r\n"
                                "sec-websocket-version: 13\r\n\r\n")
                    .accepted);
}

TEST(Handshake, RefusesWhatIsNoWebSocket) {
    WebSocket browser;
    const auto received = browser.receive(bytesOf("GET / HTTP/1.1\r\nHost: a\r\n\r\n"));
    EXPECT_TRUE(received.close);
    EXPECT_THAT(received.answer, StartsWith("HTTP/1.1 400"));
    EXPECT_FALSE(browser.isOpen());

    auto old = request();
    old.replace(old.find("Version: 13"), 11, "Version: 8");
    EXPECT_THAT(answerHandshake(old).response, StartsWith("HTTP/1.1 426"));
    for (const std::string key :
         {"", "hlIHNhbXBsZSBub25jZQ==", "dGhlIHNhbXBsZSBub25jZQ=", "dGhlIHNhbXBsZSBub25jZQ===",
          "dGhlIHNhbXBsZSBub25jZXM=", "dGhlIHNhbXBsZSBub25j=Q==", "dGhlIHNhbXBsZSBub25j!Q=="}) {
        auto keyless = request();
        keyless.replace(keyless.find("dGhl"), 24, key);
        EXPECT_THAT(answerHandshake(keyless).response, StartsWith("HTTP/1.1 400")) << key;
    }
    EXPECT_FALSE(answerHandshake("POST / HTTP/1.1\r\n\r\n").accepted);
    EXPECT_FALSE(answerHandshake("").accepted);
}

TEST(Handshake, EndsWhenTheRequestDoesNot) {
    WebSocket socket;
    const auto received = socket.receive(bytesOf(std::string(kLongestRequest + 1, 'a')));
    EXPECT_TRUE(received.close);
}

TEST(WebSocket, TakesMessagesOfEveryLength) {
    auto socket = openSocket();
    for (const std::size_t size : {0U, 1U, 125U, 126U, 0xFFFFU, 0x10000U, 999'000U}) {
        const std::string message(size, 'x');
        EXPECT_THAT(socket.receive(bytesOf(frame(0x81, message))).messages, ElementsAre(message));
    }
}

TEST(WebSocket, TakesSeveralMessagesInOneRead) {
    auto socket = openSocket();
    EXPECT_THAT(
        socket.receive(bytesOf(frame(0x81, "a") + frame(0x82, "b") + frame(0x81, "c"))).messages,
        ElementsAre("a", "b", "c"));
}

TEST(WebSocket, JoinsFragmentsWithAPingBetween) {
    auto socket = openSocket();
    EXPECT_THAT(socket.receive(bytesOf(frame(0x01, "Hel"))).messages, IsEmpty());
    EXPECT_EQ(socket.receive(bytesOf(frame(0x89, "Hello"))).answer, "\x8A\x05Hello");
    EXPECT_THAT(socket.receive(bytesOf(frame(0x00, "l"))).messages, IsEmpty());
    EXPECT_THAT(socket.receive(bytesOf(frame(0x80, "o"))).messages, ElementsAre("Hello"));
}

TEST(WebSocket, WritesFramesWithTheShortestLength) {
    EXPECT_EQ(WebSocket::textFrame("Hello"), "\x81\x05Hello");
    EXPECT_EQ(WebSocket::textFrame(std::string(256, 'a')).substr(0, 4), "\x81\x7E\x01\x00"s);
    EXPECT_EQ(WebSocket::textFrame(std::string(65536, 'a')).substr(0, 10),
              "\x81\x7F\x00\x00\x00\x00\x00\x01\x00\x00"s);
}

TEST(WebSocket, AnswersACloseWithTheSameStatus) {
    auto socket = openSocket();
    const auto received = socket.receive(bytesOf(frame(0x88, "\x03\xE8gone"s)));
    EXPECT_EQ(received.answer, closing(1000));
    EXPECT_TRUE(received.close);
    EXPECT_THAT(socket.receive(bytesOf(frame(0x81, "late"))).messages, IsEmpty());
}

TEST(WebSocket, APingHasRoomBetweenTheFragmentsOfTheLongestMessage) {
    auto socket = openSocket();
    const std::string message(kLongestMessage, 'a');
    socket.receive(bytesOf(frame(0x01, message)));
    const auto ping = socket.receive(bytesOf(frame(0x89, "hello")));
    EXPECT_EQ(ping.answer, "\x8A\x05hello");
    EXPECT_FALSE(ping.close);
    const auto whole = socket.receive(bytesOf(frame(0x80, ""))).messages;
    ASSERT_EQ(whole.size(), 1U);
    EXPECT_TRUE(whole.front() == message) << "a million letters";
}

TEST(WebSocket, TakesTheSameFromEveryDivisionIntoReads) {
    const std::string stream = frame(0x81, "one") + frame(0x01, "tw") + frame(0x89, "p") +
                               frame(0x80, "o") + frame(0x82, std::string(300, 'x')) +
                               frame(0x8A, "") + frame(0x88, "\x03\xE8"s);
    for (std::size_t first = 0; first <= stream.size(); ++first) {
        auto socket = openSocket();
        auto received = socket.receive(bytesOf(stream.substr(0, first)));
        const auto rest = socket.receive(bytesOf(stream.substr(first)));
        received.messages.insert(received.messages.end(), rest.messages.begin(),
                                 rest.messages.end());
        EXPECT_THAT(received.messages, ElementsAre("one", "two", std::string(300, 'x'))) << first;
        EXPECT_EQ(received.answer + rest.answer, "\x8A\x01p" + closing(1000)) << first;
        EXPECT_TRUE(received.close || rest.close) << first;
    }
}

TEST(WebSocket, KeepsTheMessagesBeforeAFrameThatBreaksTheProtocol) {
    auto socket = openSocket();
    const auto received = socket.receive(bytesOf(frame(0x81, "good") + frame(0x83, "bad")));
    EXPECT_THAT(received.messages, ElementsAre("good"));
    EXPECT_EQ(received.answer, closing(1002));
    EXPECT_FALSE(socket.isOpen());
}

TEST(WebSocket, TakesNothingAfterARefusedHandshake) {
    WebSocket socket;
    EXPECT_TRUE(socket.receive(bytesOf("POST / HTTP/1.1\r\n\r\n")).close);
    const auto late = socket.receive(bytesOf(request() + frame(0x81, "late")));
    EXPECT_THAT(late.messages, IsEmpty());
    EXPECT_EQ(late.answer, "");
    EXPECT_FALSE(socket.isOpen());
}

struct Broken {
    const char* name;
    std::string bytes;
    std::uint16_t status;
};
void PrintTo(const Broken& broken, std::ostream* out) {
    *out << broken.name;
}

class BrokenFrame : public testing::TestWithParam<Broken> {};

TEST_P(BrokenFrame, ClosesTheConnectionWithItsStatus) {
    auto socket = openSocket();
    const auto received = socket.receive(bytesOf(GetParam().bytes));
    EXPECT_EQ(received.answer, closing(GetParam().status));
    EXPECT_TRUE(received.close);
    EXPECT_THAT(received.messages, IsEmpty());
}

INSTANTIATE_TEST_SUITE_P(
    Kinds, BrokenFrame,
    testing::Values(Broken{"Unmasked", "\x81\x05Hello", 1002},
                    Broken{"ReservedBit", frame(0xC1, "a"), 1002},
                    Broken{"UnknownOpcode", frame(0x83, "a"), 1002},
                    Broken{"UnknownControl", frame(0x8B, "a"), 1002},
                    Broken{"FragmentedControl", frame(0x09, "a"), 1002},
                    Broken{"LongControl", frame(0x89, std::string(126, 'a')), 1002},
                    Broken{"ContinuationOfNothing", frame(0x80, "a"), 1002},
                    Broken{"TextWithinText", frame(0x01, "a") + frame(0x81, "b"), 1002},
                    Broken{"NotUtf8", frame(0x81, "\xFF"), 1007},
                    Broken{"TooLong", "\x81\xFF\x00\x00\x00\x00\x00\x10\x00\x00mask"s, 1009},
                    Broken{"Endless", "\x81\xFF\xFF\xFF\xFF\xFF\xFF\xFF\xFF\xFFmask"s, 1009},
                    Broken{"TooManyFragments",
                           frame(0x01, std::string(600'000, 'a')) +
                               frame(0x00, std::string(600'000, 'a')),
                           1009},
                    Broken{"CloseWithHalfAStatus", frame(0x88, "a"), 1002},
                    Broken{"CloseWithAStatusThatIsNone", frame(0x88, "\x03\xEE"s), 1002}),
    [](const auto& tested) { return std::string(tested.param.name); });

}  // namespace
}  // namespace metier::virtual_edo
