#include "chain.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <cctype>
#include <chrono>

namespace metier::security {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

Entry entryOf(std::string event) {
    const auto time =
        UtcTime{} + std::chrono::seconds(1'700'000'000) + std::chrono::milliseconds(42);
    return {time, std::move(event), {{"user", "anna"}, {"skill", "JointPtpMoveSkill"}}};
}

TEST(Chain, IsALineOfJson) {
    const auto line = chainLine(entryOf("Start"), 7, kNoChain);
    EXPECT_THAT(line.text, StartsWith(R"({"n":7,"time":"2023-11-14T22:13:20.042Z","event":"Start",)"
                                      R"("user":"anna","skill":"JointPtpMoveSkill","chain":")"));
    EXPECT_EQ(line.chain.size(), 64U);
    const auto read = readLine(line.text, kNoChain);
    ASSERT_TRUE(read);
    EXPECT_EQ(read->number, 7U);
    EXPECT_EQ(read->chain, line.chain);
}

TEST(Chain, IsBrokenByEachChange) {
    const auto first = chainLine(entryOf("Start"), 1, kNoChain);
    const auto second = chainLine(entryOf("Halt"), 2, first.chain);
    EXPECT_TRUE(readLine(second.text, first.chain));
    EXPECT_FALSE(readLine(second.text, kNoChain)) << "another line before";
    auto changed = second.text;
    changed.replace(changed.find("anna"), 4, "bert");
    EXPECT_FALSE(readLine(changed, first.chain));
    EXPECT_FALSE(readLine(second.text + " ", first.chain));
    EXPECT_FALSE(readLine("", first.chain));
    EXPECT_FALSE(readLine("{}", first.chain));
}

TEST(Chain, IsNoneInADamagedLine) {
    EXPECT_FALSE(readLastLine(R"({"n":1,"time":"","event":{"a":1,"chain":"0"})"));
    EXPECT_FALSE(readLastLine(R"({"n":1,"time":"","a":{"b":1,"chain":"0"},"c":"1"})"
                              R"(,"chain":7,"d":"2"})"));
    const std::string nested = R"({"n":1,"time":"","a":[{"b":1,"chain":"0"}],"c":"0"})";
    EXPECT_FALSE(readLastLine(nested)) << "a chain of something else";
    const auto line = chainLine(entryOf("Start"), 1, kNoChain);
    auto numbered = line.text;
    numbered.replace(numbered.find("\"Start\""), 7, "7");
    EXPECT_TRUE(readLastLine(numbered)) << "an event that is no text is not a continuation";
}

TEST(Chain, EndsWithTheLine) {
    const auto line = chainLine(entryOf("Start"), 1, kNoChain);
    const auto inner = line.text.substr(0, line.text.size() - 1);  // without the brace
    for (const std::string more :
         {R"(,"user":"bert"})", R"(,"event":"Reset","user":"bert","x":"1"})", R"( })",
          R"(,"a":""})"}) {
        EXPECT_FALSE(readLine(inner + more, kNoChain)) << more << " is not hashed";
        EXPECT_FALSE(readLastLine(inner + more)) << more;
    }
    auto upper = line.text;
    std::transform(upper.end() - 66, upper.end() - 2, upper.end() - 66,
                   [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
    EXPECT_FALSE(readLastLine(upper)) << "another writing of the same value";
    auto shorter = line.text;
    shorter.erase(shorter.size() - 3, 1);
    EXPECT_FALSE(readLastLine(shorter));
    auto longer = line.text;
    longer.insert(longer.size() - 2, "0");
    EXPECT_FALSE(readLastLine(longer));
}

TEST(Chain, HoldsWhateverAPeerIsCalled) {
    auto entry = entryOf("Login");
    entry.fields = {{"user", "a\"},\n\"chain\":\"x\"}"}, {"name", "\xff\xfe\x01"}};
    const auto line = chainLine(entry, 1, kNoChain);
    EXPECT_EQ(line.text.find('\n'), std::string::npos);
    EXPECT_TRUE(std::all_of(line.text.begin(), line.text.end(),
                            [](char c) { return c >= ' ' && c <= '~'; }));
    EXPECT_TRUE(readLine(line.text, kNoChain));
    entry.fields = {{"chain", "mine"}, {"n", "0"}};
    EXPECT_FALSE(readLine(chainLine(entry, 1, kNoChain).text, kNoChain))
        << "nobody but the log writes these";
}

TEST(Chain, HoldsTextsUpToAThousandBytes) {
    auto entry = entryOf("Login");
    entry.fields = {{"whole", std::string(1'000, 'x')}, {"cut", std::string(1'001, 'y')}};
    const auto line = chainLine(entry, 1, kNoChain);
    EXPECT_THAT(line.text, HasSubstr('"' + std::string(1'000, 'x') + '"'));
    EXPECT_THAT(line.text, HasSubstr('"' + std::string(1'000, 'y') + "...\""));
    // The last letter is cut in two: what is left of it is no UTF-8.
    entry.fields = {{"user", std::string(999, 'z') + "\xc3\xa4"}};
    const auto cut = chainLine(entry, 1, kNoChain);
    EXPECT_THAT(cut.text, HasSubstr("z\\ufffd...\""));
    EXPECT_TRUE(readLine(cut.text, kNoChain));
}

TEST(Chain, CountsTimeAlsoBefore1970) {
    auto entry = entryOf("Start");
    entry.time = UtcTime{} - std::chrono::milliseconds(1);
    EXPECT_THAT(chainLine(entry, 1, kNoChain).text,
                HasSubstr(R"("time":"1969-12-31T23:59:59.999Z")"));
}

TEST(Chain, IsNoneWithoutNumberOrTime) {
    const auto line = chainLine(entryOf("Start"), 1, kNoChain).text;
    ASSERT_TRUE(readLastLine(line));
    for (const auto* number : {"-1", "1.5", "\"1\"", "null"}) {
        auto other = line;
        other.replace(other.find(":1,") + 1, 1, number);
        EXPECT_FALSE(readLastLine(other)) << number;
    }
    auto timeless = line;
    timeless.replace(timeless.find("time"), 4, "date");
    EXPECT_FALSE(readLastLine(timeless));
}

}  // namespace
}  // namespace metier::security
