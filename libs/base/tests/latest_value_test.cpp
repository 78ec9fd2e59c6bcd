#include "metier/base/latest_value.hpp"

#include <gtest/gtest.h>

#include <array>
#include <thread>

namespace metier {
namespace {

TEST(LatestValue, HoldsTheInitialValueBeforeTheFirstWrite) {
    LatestValue<int> slot(7);
    EXPECT_FALSE(slot.hasNew());
    EXPECT_EQ(slot.read(), 7);
}

TEST(LatestValue, GivesTheNewestAndKeepsIt) {
    LatestValue<int> slot;
    slot.write(1);
    slot.write(2);
    EXPECT_TRUE(slot.hasNew());
    EXPECT_EQ(slot.read(), 2);
    EXPECT_FALSE(slot.hasNew());
    EXPECT_EQ(slot.read(), 2);
}

TEST(LatestValue, NeverTearsAValueBetweenThreads) {
    using Block = std::array<int, 64>;
    constexpr int kCount = 100'000;
    LatestValue<Block> slot;
    const std::jthread writer([&] {
        for (int i = 1; i <= kCount; ++i) {
            Block block;
            block.fill(i);
            slot.write(block);
        }
    });
    int last = 0;
    while (last < kCount) {
        const Block& block = slot.read();
        ASSERT_EQ(block.front(), block.back());
        ASSERT_GE(block.front(), last);
        last = block.front();
    }
}

}  // namespace
}  // namespace metier
