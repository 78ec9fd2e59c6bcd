#include "metier/device/reset_desk.hpp"

#include <gtest/gtest.h>

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

}  // namespace
}  // namespace metier::device
