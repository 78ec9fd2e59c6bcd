#include "metier/device/reset_desk.hpp"

#include <gtest/gtest.h>

#include <future>

namespace metier::device {
namespace {

using namespace std::chrono_literals;

static_assert(kResetWait <= 50ms, "a server's thread waits so long");

TEST(ResetDesk, GivesTheAnswerToAllWhoWait) {
    ResetDesk desk;
    auto first = std::async(std::launch::async, [&] { return desk.ask(20s); });
    while (!desk.taken()) {
        std::this_thread::yield();
    }
    desk.answer(fail(Errc::device_fault, "too hot"));
    EXPECT_EQ(first.get().value().error().message, "too hot");
    EXPECT_FALSE(desk.ask(0s)) << "it was heard: a new one begins";
    EXPECT_TRUE(desk.taken());
}

TEST(ResetDesk, TellsAFailureThatNobodyHeardToWhoAsksNextAndOnce) {
    ResetDesk desk;
    EXPECT_FALSE(desk.ask(0s));
    ASSERT_TRUE(desk.taken());
    EXPECT_FALSE(desk.ask(0s)) << "still under way";
    EXPECT_TRUE(desk.underWay());
    EXPECT_FALSE(desk.taken());
    desk.answer(fail(Errc::device_fault, "too hot"));
    EXPECT_EQ(desk.ask(0s).value().error().message, "too hot");
    EXPECT_FALSE(desk.ask(0s));
    EXPECT_TRUE(desk.taken());
}

TEST(ResetDesk, DoesNotTakeASuccessThatNobodyHeardForTheEndOfALaterFault) {
    ResetDesk desk;
    EXPECT_FALSE(desk.ask(0s));
    ASSERT_TRUE(desk.taken());
    desk.answer({});
    EXPECT_FALSE(desk.underWay());
    EXPECT_FALSE(desk.ask(0s)) << "a new fault, a new reset";
    EXPECT_TRUE(desk.taken());
}

TEST(ResetDesk, AnAnswerThatNobodyAskedForIsNoAnswer) {
    ResetDesk desk;
    desk.answer(fail(Errc::connection_lost, "gone"));
    EXPECT_FALSE(desk.ask(0s));
}

}  // namespace
}  // namespace metier::device
