#include "metier/device/reset_slot.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <thread>

namespace metier::device {
namespace {

TEST(ResetSlot, LetsSeveralAskForOneReset) {
    ResetSlot slot;
    EXPECT_FALSE(slot.ask());
    EXPECT_FALSE(slot.ask());
    EXPECT_TRUE(slot.taken());
    EXPECT_FALSE(slot.taken());
    slot.answer(fail(Errc::device_fault, "too hot"));
    EXPECT_FALSE(slot.underWay());
    EXPECT_EQ(slot.ask().value().error().message, "too hot");
    EXPECT_FALSE(slot.ask()) << "it was heard: a new one begins";
    EXPECT_TRUE(slot.taken());
}

TEST(ResetSlot, TellsAFailureThatNobodyHeardToWhoAsksNextAndOnce) {
    ResetSlot slot;
    EXPECT_FALSE(slot.ask());
    ASSERT_TRUE(slot.taken());
    EXPECT_FALSE(slot.ask()) << "still under way";
    EXPECT_TRUE(slot.underWay());
    EXPECT_FALSE(slot.taken());
    slot.answer(fail(Errc::device_fault, "too hot"));
    EXPECT_EQ(slot.ask().value().error().message, "too hot");
    EXPECT_FALSE(slot.ask());
    EXPECT_TRUE(slot.taken());
}

TEST(ResetSlot, DoesNotTakeASuccessThatNobodyHeardForTheEndOfALaterFault) {
    ResetSlot slot;
    EXPECT_FALSE(slot.ask());
    ASSERT_TRUE(slot.taken());
    slot.answer({});
    EXPECT_FALSE(slot.underWay());
    EXPECT_FALSE(slot.ask()) << "a new fault, a new reset";
    EXPECT_TRUE(slot.taken());
}

TEST(ResetSlot, AnAnswerThatNobodyAskedForIsNoAnswer) {
    ResetSlot slot;
    slot.answer(fail(Errc::connection_lost, "gone"));
    EXPECT_FALSE(slot.ask());
}

TEST(ResetSlot, AsksNoDeviceThatAnsweredBeforeItWasAsked) {
    ResetSlot slot;
    EXPECT_FALSE(slot.ask());
    slot.answer(fail(Errc::connection_lost, "gone"));  // before anybody took the request
    EXPECT_FALSE(slot.taken());
    EXPECT_EQ(slot.ask().value().error().message, "gone");
}

// For the thread sanitizer: clients ask on one thread, a device answers on another.
TEST(ResetSlot, MayBeUsedByManyThreads) {
    ResetSlot slot;
    std::atomic<bool> done{false};
    std::jthread device([&] {
        while (!done.load()) {
            if (slot.taken()) {
                slot.answer(fail(Errc::device_fault, "too hot"));
            }
            std::this_thread::yield();
        }
    });
    for (int failures = 0; failures < 20;) {
        static_cast<void>(slot.underWay());
        if (const auto outcome = slot.ask()) {
            EXPECT_EQ(outcome->error().message, "too hot");
            ++failures;
        }
        std::this_thread::yield();
    }
    done.store(true);
}

}  // namespace
}  // namespace metier::device
