#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <thread>
#include <vector>

#include "metier/skill/testing/manual_executor.hpp"

namespace metier::skill::testing {
namespace {

using namespace std::chrono_literals;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

TEST(Timer, CancelsWhenItIsDestroyedOrReplaced) {
    int cancelled = 0;
    {
        Timer first([&] { ++cancelled; });
        Timer second(std::move(first));
        EXPECT_EQ(cancelled, 0);
        second = Timer([&] { cancelled += 10; });
        EXPECT_EQ(cancelled, 1);
        second.cancel();
        second.cancel();
        EXPECT_EQ(cancelled, 11);
    }
    EXPECT_EQ(cancelled, 11);
}

TEST(ManualExecutor, RunsPostedWorkInOrderAndNeverInsidePost) {
    ManualExecutor executor;
    std::vector<int> done;
    executor.post([&] {
        executor.post([&] { done.push_back(3); });
        done.push_back(1);
    });
    executor.post([&] { done.push_back(2); });
    EXPECT_THAT(done, IsEmpty());
    executor.run();
    EXPECT_THAT(done, ElementsAre(1, 2, 3));
}

TEST(ManualExecutor, RunsTimersAtTheirTimeInTheirOrder) {
    ManualExecutor executor;
    const auto start = executor.clock().now();
    std::vector<std::chrono::nanoseconds> done;
    const auto note = [&] { done.push_back(executor.clock().now() - start); };
    const auto late = executor.after(30ms, note);
    const auto early = executor.after(10ms, note);
    executor.advance(20ms);
    EXPECT_THAT(done, ElementsAre(10ms));
    executor.advance(20ms);
    EXPECT_THAT(done, ElementsAre(10ms, 30ms));
    EXPECT_EQ(executor.clock().now() - start, 40ms);
}

TEST(ManualExecutor, ForgetsACancelledTimerAlsoIfItCancelsItself) {
    ManualExecutor executor;
    int runs = 0;
    auto never = executor.after(10ms, [&] { runs += 10; });
    Timer once;
    once = executor.after(20ms, [&] {
        ++runs;
        once.cancel();
    });
    never.cancel();
    executor.advance(1s);
    EXPECT_EQ(runs, 1);
    EXPECT_EQ(executor.timerCount(), 0U);
}

TEST(ManualExecutor, WaitsForOtherThreads) {
    ManualExecutor executor;
    int value = 0;
    const std::jthread other([&] { executor.post([&] { value = 1; }); });
    EXPECT_TRUE(executor.runUntil([&] { return value == 1; }));
    EXPECT_FALSE(executor.runUntil([&] { return value == 2; }, 1ms));
}

}  // namespace
}  // namespace metier::skill::testing
