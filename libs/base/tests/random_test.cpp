#include "metier/base/random.hpp"

#include <gmock/gmock.h>

#include <set>

namespace metier {
namespace {

using ::testing::MatchesRegex;

TEST(Random, HasAsManyHexadecimalDigitsAsAskedFor) {
    EXPECT_EQ(randomHex(0), "");
    EXPECT_THAT(randomHex(1), MatchesRegex("[0-9a-f]"));
    EXPECT_THAT(randomHex(6), MatchesRegex("[0-9a-f]{6}"));
    EXPECT_THAT(randomHex(40), MatchesRegex("[0-9a-f]{40}"));
}

TEST(Random, GivesNothingTwice) {
    constexpr std::size_t kMany = 1000;
    std::set<std::uint64_t> numbers;
    std::set<std::string> texts;
    for (std::size_t i = 0; i < kMany; ++i) {
        numbers.insert(randomNumber());
        texts.insert(randomHex(32));
    }
    EXPECT_EQ(numbers.size(), kMany);
    EXPECT_EQ(texts.size(), kMany);
}

TEST(Random, LeavesNoBitOut) {
    std::uint64_t ever_set = 0;
    std::uint64_t always_set = ~std::uint64_t{0};
    for (int i = 0; i < 200; ++i) {
        const auto number = randomNumber();
        ever_set |= number;
        always_set &= number;
    }
    EXPECT_EQ(ever_set, ~std::uint64_t{0});
    EXPECT_EQ(always_set, 0U);
}

}  // namespace
}  // namespace metier
