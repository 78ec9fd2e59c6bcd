#include "metier/device/reset_desk.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <thread>

namespace metier::device {
namespace {

TEST(ResetDesk, LetsSeveralAskForOneReset) {
    ResetDesk desk;
    EXPECT_FALSE(desk.ask());
    EXPECT_FALSE(desk.ask());
    EXPECT_TRUE(desk.taken());
    EXPECT_FALSE(desk.taken());
    desk.answer(fail(Errc::device_fault, "too hot"));
    EXPECT_FALSE(desk.underWay());
    EXPECT_EQ(desk.ask().value().error().message, "too hot");
    EXPECT_FALSE(desk.ask()) << "it was heard: a new one begins";
    EXPECT_TRUE(desk.taken());
}

TEST(ResetDesk, TellsAFailureThatNobodyHeardToWhoAsksNextAndOnce) {
    ResetDesk desk;
    EXPECT_FALSE(desk.ask());
    ASSERT_TRUE(desk.taken());
    EXPECT_FALSE(desk.ask()) << "still under way";
    EXPECT_TRUE(desk.underWay());
    EXPECT_FALSE(desk.taken());
    desk.answer(fail(Errc::device_fault, "too hot"));
    EXPECT_EQ(desk.ask().value().error().message, "too hot");
    EXPECT_FALSE(desk.ask());
    EXPECT_TRUE(desk.taken());
}

TEST(ResetDesk, DoesNotTakeASuccessThatNobodyHeardForTheEndOfALaterFault) {
    ResetDesk desk;
    EXPECT_FALSE(desk.ask());
    ASSERT_TRUE(desk.taken());
    desk.answer({});
    EXPECT_FALSE(desk.underWay());
    EXPECT_FALSE(desk.ask()) << "a new fault, a new reset";
    EXPECT_TRUE(desk.taken());
}

TEST(ResetDesk, AnAnswerThatNobodyAskedForIsNoAnswer) {
    ResetDesk desk;
    desk.answer(fail(Errc::connection_lost, "gone"));
    EXPECT_FALSE(desk.ask());
}

TEST(ResetDesk, AsksNoDeviceThatAnsweredBeforeItWasAsked) {
    ResetDesk desk;
    EXPECT_FALSE(desk.ask());
    desk.answer(fail(Errc::connection_lost, "gone"));  // before anybody took the request
    EXPECT_FALSE(desk.taken());
    EXPECT_EQ(desk.ask().value().error().message, "gone");
}

// For the thread sanitizer: clients ask on one thread, a device answers on another.
TEST(ResetDesk, MayBeUsedByManyThreads) {
    ResetDesk desk;
    std::atomic<bool> done{false};
    std::jthread device([&] {
        while (!done.load()) {
            if (desk.taken()) {
                desk.answer(fail(Errc::device_fault, "too hot"));
            }
            std::this_thread::yield();
        }
    });
    for (int failures = 0; failures < 20;) {
        static_cast<void>(desk.underWay());
        if (const auto outcome = desk.ask()) {
            EXPECT_EQ(outcome->error().message, "too hot");
            ++failures;
        }
        std::this_thread::yield();
    }
    done.store(true);
}

}  // namespace
}  // namespace metier::device
