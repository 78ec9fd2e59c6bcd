#include "metier/base/queue.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <memory>
#include <thread>
#include <vector>

namespace metier {
namespace {

using namespace std::chrono_literals;

SteadyTime soon() {
    return std::chrono::steady_clock::now() + 30s;
}

TEST(Queue, GivesElementsInTheOrderTheyCame) {
    Queue<int> queue(4);
    EXPECT_TRUE(queue.tryPush(1));
    EXPECT_TRUE(queue.tryPush(2));
    EXPECT_EQ(queue.popUntil(soon()), 1);
    EXPECT_EQ(queue.popUntil(soon()), 2);
}

TEST(Queue, RefusesMoreThanItsCapacity) {
    Queue<int> queue(1);
    EXPECT_TRUE(queue.tryPush(1));
    EXPECT_FALSE(queue.tryPush(2));
}

TEST(Queue, ReturnsNothingWhenTheDeadlinePasses) {
    Queue<int> queue(1);
    EXPECT_EQ(queue.popUntil(std::chrono::steady_clock::now()), std::nullopt);
}

TEST(Queue, WakesAWaiterWhenClosed) {
    Queue<int> queue(1);
    std::optional<int> popped = 7;
    {
        const std::jthread waiter([&] { popped = queue.popUntil(soon()); });
        queue.close();
    }
    EXPECT_EQ(popped, std::nullopt);
    EXPECT_FALSE(queue.tryPush(1));
}

TEST(Queue, LosesNothingBetweenThreads) {
    constexpr int kCount = 10'000;
    Queue<std::unique_ptr<int>> queue(kCount);
    const std::jthread producer([&] {
        for (int i = 0; i < kCount; ++i) {
            queue.tryPush(std::make_unique<int>(i));
        }
    });
    for (int i = 0; i < kCount; ++i) {
        const auto value = queue.popUntil(soon());
        ASSERT_TRUE(value);
        ASSERT_EQ(**value, i);
    }
}

}  // namespace
}  // namespace metier
