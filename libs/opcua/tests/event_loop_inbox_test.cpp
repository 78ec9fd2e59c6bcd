#include <gmock/gmock.h>

#include <string>
#include <string_view>
#include <vector>

#include "inbox.hpp"

namespace metier::opcua {
namespace {

std::string chunk(std::size_t size) {
    std::string bytes("MSGF\0\0\0\0", 8);
    bytes[4] = static_cast<char>(size & 0xFFU);
    bytes[5] = static_cast<char>(size >> 8U);
    return bytes + std::string(size - bytes.size(), 'x');
}

void push(Inbox& inbox, std::string_view text) {
    inbox.push({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});  // NOLINT
}

std::string take(Inbox& inbox) {
    const auto bytes = inbox.take();
    std::string text(bytes.begin(), bytes.end());
    inbox.done();
    return text;
}

TEST(Inbox, GivesOneChunkAfterTheOther) {
    Inbox inbox;
    push(inbox, chunk(20) + chunk(300) + chunk(8));
    for (const std::size_t size : {20U, 300U, 8U}) {
        ASSERT_FALSE(inbox.empty());
        EXPECT_EQ(take(inbox), chunk(size));
    }
    EXPECT_TRUE(inbox.empty());
}

TEST(Inbox, GivesWhatThereIsOfAChunkHoweverItIsCut) {
    const auto two = chunk(30) + chunk(40);
    for (std::size_t cut = 1; cut < two.size(); ++cut) {
        Inbox inbox;
        std::vector<std::string> got;
        for (const auto& part : {two.substr(0, cut), two.substr(cut) + chunk(9)}) {
            push(inbox, part);
            while (!inbox.empty()) {
                got.push_back(take(inbox));
            }
        }
        std::string all;
        for (const auto& piece : got) {
            all += piece;
        }
        EXPECT_EQ(all, two + chunk(9));
        EXPECT_EQ(got.size(), cut == 30 ? 3U : 4U) << cut;
    }
}

TEST(Inbox, LeavesToTheStackWhatIsNoChunk) {
    for (const std::string& garbage :
         {std::string("MSGF\7\0\0\0 and more", 17), std::string("GET / HTTP/1.1\r\n\r\n")}) {
        Inbox inbox;
        push(inbox, chunk(10) + garbage);
        EXPECT_EQ(take(inbox), chunk(10));
        EXPECT_EQ(take(inbox), garbage);
        EXPECT_TRUE(inbox.empty());
    }
}

}  // namespace
}  // namespace metier::opcua
