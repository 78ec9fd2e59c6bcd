#include <gmock/gmock.h>

#include <algorithm>

#include "fair_queue.hpp"

namespace metier::opcua {
namespace {

using namespace std::chrono_literals;
using ::testing::ElementsAre;

const SteadyTime kStart{1000s};

std::vector<ConnectionId> served(FairQueue& turns, std::size_t count, FairQueue::Cost cost = 1ms) {
    std::vector<ConnectionId> order;
    while (order.size() < count && !turns.empty()) {
        order.push_back(*turns.next());
        turns.used(cost);
    }
    return order;
}

TEST(FairQueue, AreTakenInTheOrderOfWaitingByThoseWhoHaveCostTheSame) {
    FairQueue turns;
    for (const ConnectionId id : {3U, 1U, 2U}) {
        turns.ready(id, Standing::member, kStart);
        turns.ready(id, Standing::member, kStart);
    }
    EXPECT_THAT(served(turns, 4), ElementsAre(3, 1, 2));
    EXPECT_FALSE(turns.next());
}

TEST(FairQueue, WhoCostsLittleWaitsForNoMoreThanOneOfThoseWhoCostMuch) {
    FairQueue turns;
    auto now = kStart;
    for (ConnectionId busy = 1; busy <= 100; ++busy) {
        turns.ready(busy, Standing::member, now);
    }
    constexpr ConnectionId quiet = 1000;
    turns.ready(quiet, Standing::member, now);
    std::size_t waited = 0;
    std::size_t most = 0;
    for (int turn = 0; turn < 5000; ++turn) {  // each is ready again at once
        const auto id = *turns.next();
        const auto cost = id == quiet ? 50us : 2000us;
        turns.used(cost);
        now += cost;
        turns.ready(id, Standing::member, now);
        waited = id == quiet ? 0 : waited + 1;
        most = turn < 1000 ? 0 : std::max(most, waited);  // once it is known who costs how much
    }
    EXPECT_LE(most, 5U);  // 10 ms, its own 50 us 200 times
}

TEST(FairQueue, NobodyWaitsForEver) {
    FairQueue turns;
    auto now = kStart;
    turns.ready(1, Standing::member, now);
    turns.used((turns.next(), 20ms));
    turns.ready(1, Standing::member, now);
    bool served_at_last = false;
    for (int turn = 0; turn < 20'000 && !served_at_last; ++turn) {
        turns.ready(2, Standing::member, now);
        served_at_last = turns.next() == 1U;
        turns.used(50us);
        now += 50us;
    }
    EXPECT_TRUE(served_at_last);
}

TEST(FairQueue, StrangersGetHalfOfTheTimeHoweverManyTheyAre) {
    FairQueue turns;
    for (ConnectionId stranger = 1; stranger <= 100; ++stranger) {
        turns.ready(stranger, Standing::stranger, kStart);
    }
    constexpr ConnectionId member = 1000;
    std::size_t of_member = 0;
    for (int turn = 0; turn < 1000; ++turn) {
        turns.ready(member, Standing::member, kStart);
        const auto id = served(turns, 1).front();
        of_member += id == member ? 1 : 0;
        turns.ready(id, id == member ? Standing::member : Standing::stranger, kStart);
    }
    EXPECT_NEAR(static_cast<double>(of_member), 500, 2);
}

TEST(FairQueue, WhoIsForgottenIsNotServed) {
    FairQueue turns;
    turns.ready(1, Standing::member, kStart);
    turns.ready(2, Standing::stranger, kStart);
    turns.forget(1);
    turns.forget(3);
    EXPECT_THAT(served(turns, 2), ElementsAre(2));
    turns.forget(2);  // the connection that had the last turn
    turns.used(1ms);
    EXPECT_TRUE(turns.empty());
}

}  // namespace
}  // namespace metier::opcua
