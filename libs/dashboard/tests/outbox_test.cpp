// Messages that wait for a tab, and log-ins that wait for their turn.
#include "outbox.hpp"

#include <gmock/gmock.h>

#include <atomic>
#include <chrono>
#include <future>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>
#include <vector>

#include "login_queue.hpp"

namespace metier::dashboard {
namespace {

using namespace std::chrono_literals;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::Pointee;

Message messageOf(std::size_t bytes) {
    return std::make_shared<const std::string>(bytes, 'x');
}

SteadyTime inTime() {
    return std::chrono::steady_clock::now() + 30s;
}

TEST(OutboxTest, GivesAllThatWaitsInItsOrder) {
    Outbox outbox(1'000);
    for (const auto* text : {"one", "two", "three"}) {
        outbox.push(std::make_shared<const std::string>(text));
    }
    EXPECT_THAT(outbox.take(inTime()),
                ElementsAre(Pointee(std::string("one")), Pointee(std::string("two")),
                            Pointee(std::string("three"))));
    EXPECT_THAT(outbox.take({}), IsEmpty());
}

TEST(OutboxTest, GivesUpASlowReaderAtItsLimitAndNotBefore) {
    Outbox outbox(1'000);
    outbox.push(messageOf(600));
    outbox.push(messageOf(400));
    EXPECT_FALSE(outbox.isClosed()) << "as much may wait";
    outbox.push(messageOf(1));
    EXPECT_TRUE(outbox.isClosed());
    EXPECT_THAT(outbox.take(inTime()), IsEmpty()) << "half a story is worth nothing";
    outbox.push(messageOf(1));
    EXPECT_THAT(outbox.take(inTime()), IsEmpty());
}

TEST(OutboxTest, CountsWhatWaitsAlone) {
    Outbox outbox(1'000);
    for (int i = 0; i < 100; ++i) {
        outbox.push(messageOf(900));
        EXPECT_EQ(outbox.take(inTime()).size(), 1U) << i;
    }
    EXPECT_FALSE(outbox.isClosed());
}

TEST(OutboxTest, WakesAReaderByAMessage) {
    Outbox outbox(1'000);
    auto taken = std::async(std::launch::async, [&] { return outbox.take(inTime()); });
    outbox.push(messageOf(1));
    EXPECT_EQ(taken.get().size(), 1U);
}

TEST(OutboxTest, WakesAReaderByItsEnd) {
    Outbox outbox(1'000);
    auto taken = std::async(std::launch::async, [&] {
        auto messages = outbox.take(inTime());
        return outbox.isClosed() && messages.empty();
    });
    outbox.close();
    EXPECT_TRUE(taken.get());
}

TEST(OutboxTest, GivesWhatWaitedBeforeItWasClosed) {
    Outbox outbox(1'000);
    outbox.push(messageOf(1));
    outbox.close();
    outbox.push(messageOf(1));
    EXPECT_EQ(outbox.take(inTime()).size(), 1U);
}

TEST(OutboxTest, LosesNothingBetweenWritersAndAReader) {
    constexpr std::size_t kEach = 2'000;
    Outbox outbox(10'000'000);
    std::vector<std::jthread> writers;
    for (int i = 0; i < 4; ++i) {
        writers.emplace_back([&] {
            for (std::size_t n = 0; n < kEach; ++n) {
                outbox.push(messageOf(1));
            }
        });
    }
    std::size_t taken = 0;
    while (taken < 4 * kEach) {
        const auto count = outbox.take(inTime()).size();
        ASSERT_GT(count, 0U);
        taken += count;
    }
    EXPECT_EQ(taken, 4 * kEach);
}

TEST(LoginQueueTest, LetsSoManyAtATime) {
    constexpr int kPeople = 40;
    LoginQueue queue(3);
    std::atomic<int> asking = 0;
    std::atomic<int> most = 0;
    std::atomic<int> served = 0;
    {
        std::vector<std::jthread> people;
        for (int i = 0; i < kPeople; ++i) {
            people.emplace_back([&] {
                const auto place = queue.await(30s);
                const int now = ++asking;
                for (int before = most; before < now && !most.compare_exchange_weak(before, now);) {
                }
                std::this_thread::yield();
                --asking;
                served += place ? 1 : 0;
            });
        }
    }
    EXPECT_EQ(served, kPeople);
    EXPECT_LE(most, 3);
}

TEST(LoginQueueTest, SendsAwayWhoHasWaitedForTooLong) {
    LoginQueue queue(1);
    {
        const auto place = queue.await(0ms);
        ASSERT_TRUE(place);
        EXPECT_FALSE(queue.await(0ms));
        EXPECT_FALSE(queue.await(20ms));
    }
    EXPECT_TRUE(queue.await(0ms)) << "who went away without a place gives none back";
    EXPECT_TRUE(queue.await(0ms));
}

TEST(LoginQueueTest, GoesOnBehindSomebodyWhoGaveUp) {
    LoginQueue queue(1);
    std::future<bool> patient;
    {
        const auto place = queue.await(0ms);
        auto impatient =
            std::async(std::launch::async, [&] { return static_cast<bool>(queue.await(50ms)); });
        patient =
            std::async(std::launch::async, [&] { return static_cast<bool>(queue.await(30s)); });
        EXPECT_FALSE(impatient.get());
    }
    EXPECT_TRUE(patient.get());
}

}  // namespace
}  // namespace metier::dashboard
