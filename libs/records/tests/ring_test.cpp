// The ring of samples between threads.
#include <gtest/gtest.h>

#include <array>
#include <latch>
#include <thread>
#include <vector>

#include "sample_ring.hpp"

namespace metier::records {
namespace {

TEST(SampleRing, GivesBackInItsOrderUntilItIsFull) {
    SampleRing<int> ring(3);  // four
    EXPECT_EQ(ring.capacity(), 4U);
    EXPECT_FALSE(ring.tryTake());
    for (int round = 0; round < 5; ++round) {
        for (int i = 0; i < 4; ++i) {
            EXPECT_TRUE(ring.tryPut(10 * round + i));
        }
        EXPECT_FALSE(ring.tryPut(99));
        EXPECT_EQ(ring.size(), 4U);
        for (int i = 0; i < 4; ++i) {
            EXPECT_EQ(ring.tryTake(), 10 * round + i);
        }
        EXPECT_FALSE(ring.tryTake());
    }
}

/// A value whose halves belong together.
struct Value {
    int producer = 0;
    int number = 0;
    int sum = 0;
};

TEST(SampleRing, LosesAndMixesNothingBetweenThreads) {
    constexpr int kEach = 20'000;
    constexpr int kProducers = 3;
    SampleRing<Value> ring(16);
    std::latch begin(kProducers + 1);
    std::vector<std::jthread> producers;
    for (int p = 0; p < kProducers; ++p) {
        producers.emplace_back([&, p] {
            begin.arrive_and_wait();
            for (int i = 0; i < kEach; ++i) {
                while (!ring.tryPut({p, i, p + i})) {
                    std::this_thread::yield();
                }
            }
        });
    }
    begin.arrive_and_wait();
    std::array<int, kProducers> next{};
    for (int taken = 0; taken < kProducers * kEach;) {
        const auto value = ring.tryTake();
        if (!value) {
            std::this_thread::yield();
            continue;
        }
        ++taken;
        const auto producer = static_cast<std::size_t>(value->producer);
        ASSERT_LT(producer, next.size());
        ASSERT_EQ(value->number, next.at(producer)++);
        ASSERT_EQ(value->sum, value->producer + value->number);
    }
    EXPECT_FALSE(ring.tryTake());
}

}  // namespace
}  // namespace metier::records
