#include "metier/device/shared_value.hpp"

#include <gtest/gtest.h>

#include <array>
#include <thread>
#include <vector>

namespace metier::device {
namespace {

using Block = std::array<int, 63>;

Block filled(int value) {
    Block block{};
    block.fill(value);
    return block;
}

TEST(SharedValue, GivesTheNewestValueToEachReader) {
    SharedValue<int> value(7);
    EXPECT_EQ(value.read(), 7);
    value.write(8);
    value.write(9);
    EXPECT_EQ(value.read(), 9);
    EXPECT_EQ(value.read(), 9);
}

void expectWholeValuesUpTo(int last, const SharedValue<Block>& value) {
    int newest = 0;
    while (newest < last) {
        const Block block = value.read();
        ASSERT_EQ(block, filled(block.front()));
        ASSERT_GE(block.front(), newest);
        newest = block.front();
    }
}

TEST(SharedValue, NeverTearsAValueForSeveralReaders) {
    constexpr int kCount = 20'000;
    SharedValue<Block> value(filled(0));
    std::vector<std::jthread> readers;
    for (int i = 0; i < 2; ++i) {
        readers.emplace_back([&] { expectWholeValuesUpTo(kCount, value); });
    }
    for (int i = 1; i <= kCount; ++i) {
        value.write(filled(i));
    }
}

}  // namespace
}  // namespace metier::device
