#include "client/client_reconnection.hpp"

#include <gtest/gtest.h>

namespace metier::opcua {
namespace {

using namespace std::chrono_literals;

constexpr SteadyTime kStart{1h};

TEST(ReconnectSchedule, DoublesItsPausesUpToTheLongest) {
    ReconnectSchedule schedule({.jitter = 0.0});
    schedule.begin(kStart);
    EXPECT_EQ(schedule.next(), kStart + 200ms);
    for (const auto pause : {400ms, 800ms, 1600ms, 2000ms, 2000ms}) {
        schedule.failed(kStart);
        EXPECT_EQ(schedule.next(), kStart + pause);
    }
    schedule.begin(kStart + 1h);
    EXPECT_EQ(schedule.next(), kStart + 1h + 200ms);
}

TEST(ReconnectSchedule, ShortensEachPauseByChance) {
    ReconnectSchedule schedule({.jitter = 0.25});
    bool differs = false;
    for (int i = 0; i < 100; ++i) {
        schedule.begin(kStart);
        const auto pause = schedule.next() - kStart;
        EXPECT_GE(pause, 150ms);
        EXPECT_LE(pause, 200ms);
        differs = differs || pause != 200ms;
    }
    EXPECT_TRUE(differs);
}

TEST(ReconnectSchedule, ExpiresOnlyIfItIsToldTo) {
    ReconnectSchedule patient({});
    patient.begin(kStart);
    EXPECT_FALSE(patient.expired(kStart + 1000h));
    ReconnectSchedule hasty({.give_up_after = 1s});
    hasty.begin(kStart);
    EXPECT_FALSE(hasty.expired(kStart + 999ms));
    EXPECT_TRUE(hasty.expired(kStart + 1s));
}

TEST(NamespaceMove, FollowsEachUri) {
    const NamespaceMove move({"ua", "own", "a", "b"}, {"ua", "own", "x", "b", "a"});
    EXPECT_EQ(move(0), 0);
    EXPECT_EQ(move(1), 1);
    EXPECT_EQ(move(2), 4);
    EXPECT_EQ(move(3), 3);
}

TEST(NamespaceMove, LosesAUriThatIsGoneButNotTheServersOwn) {
    const NamespaceMove move({"ua", "urn:run:1", "a"}, {"ua", "urn:run:2"});
    EXPECT_EQ(move(1), 1);
    EXPECT_EQ(move(2), std::nullopt);
}

TEST(NamespaceMove, LeavesWhatItDoesNotKnow) {
    EXPECT_EQ(NamespaceMove()(7), 7);
}

}  // namespace
}  // namespace metier::opcua
