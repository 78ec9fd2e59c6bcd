#include "response_gate.hpp"

#include <gtest/gtest.h>

#include <string>
#include <string_view>

namespace metier::opcua {
namespace {

using namespace std::string_literals;

constexpr std::string_view kNone = "http://opcfoundation.org/UA/SecurityPolicy#None";
constexpr std::string_view kSecure = "http://opcfoundation.org/UA/SecurityPolicy#Basic256Sha256";

std::string number(std::size_t value) {
    std::string bytes;
    for (unsigned shift = 0; shift < 32; shift += 8) {
        bytes.push_back(static_cast<char>(value >> shift));
    }
    return bytes;
}

std::string chunk(std::string_view type, const std::string& content) {
    return std::string(type) + number(content.size() + 8) + content;
}

std::string message(const std::string& body, std::string_view type = "MSGF") {
    return chunk(type, std::string(16, '\1') + body);
}

std::string opened(std::string_view policy) {
    return chunk("OPNF",
                 number(1) + number(policy.size()) + std::string(policy) + std::string(40, '\xff'));
}

/// Whether it passes, in one read and byte by byte.
bool passes(const std::string& stream) {
    const auto octets = [](std::string_view bytes) {
        return std::span(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size());
    };
    ResponseGate slow;
    bool passed = true;
    for (std::size_t i = 0; i < stream.size(); ++i) {
        passed = slow.feed(octets(std::string_view(stream).substr(i, 1)));
    }
    const bool at_once = ResponseGate().feed(octets(stream));
    EXPECT_EQ(passed, at_once);
    return at_once;
}

TEST(ResponseGate, LetsAnswersPass) {
    EXPECT_TRUE(passes(chunk("ACKF", std::string(20, '\0')) + opened(kNone) +
                       message("\1\0\x7a\2 and more"s) + message("\0\x55"s) +
                       message("\2\0\0\1\2\0\0"s)));
}

TEST(ResponseGate, LetsMessagesPassThatGoOnInSeveralChunks) {
    EXPECT_TRUE(passes(message("\1\0\x7a\2 and more"s, "MSGC") + message("", "MSGC") +
                       message("\xff", "MSGF") + message("\1\0\x7a\2"s)));
    EXPECT_TRUE(passes(message("\1\0\x7a\2"s, "MSGC") + message("", "MSGA")));
}

// Messages that the stack takes for a response that it has to free, though it never filled it.
TEST(ResponseGate, KeepsBackWhatDoesNotBeginWithANumericId) {
    EXPECT_FALSE(passes(opened(kNone) + message("")));
    EXPECT_FALSE(passes(message("\1\0\x7a"s)));
    EXPECT_FALSE(passes(message("\2\0\0\1\2\0"s)));
    EXPECT_FALSE(passes(message("\3\0\0\xff\xff\xff\x7f"s)));
    EXPECT_FALSE(passes(message("\6\0\0\0\0\0\0\0"s)));
    EXPECT_FALSE(passes(message("\1\0\x7a\2"s) + message("", "MSGC")));
    EXPECT_FALSE(passes(chunk("MSGF", "\1\0"s)));
}

TEST(ResponseGate, KeepsBackAllThatFollows) {
    EXPECT_FALSE(passes(message("") + message("\1\0\x7a\2"s)));
    EXPECT_FALSE(passes("MSGF\7\0\0\0 and more"s));
}

TEST(ResponseGate, LeavesSecuredChannelsAlone) {
    EXPECT_TRUE(passes(opened(kSecure) + message("")));
    EXPECT_FALSE(passes(opened(kSecure) + opened(kNone) + message("")));
}

}  // namespace
}  // namespace metier::opcua
