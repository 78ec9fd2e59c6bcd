#include "conversation.hpp"

#include <gmock/gmock.h>

#include "talk.hpp"

namespace metier::wsg50_driver::testing {
namespace {

using namespace std::chrono_literals;
using device::SafetyState;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

TEST(ConversationBegin, AsksForLimitsAndThenForUpdatesOfEachValue) {
    Talk talk;
    talk.start();
    EXPECT_THAT(talk.sentIds(), ElementsAre(0x53, 0x33, 0x40, 0x41, 0x43, 0x45));
    EXPECT_EQ(talk.sent.back(), frame(0x45, bytes({1, 20, 0})));
    ASSERT_TRUE(talk.known_limits);
    EXPECT_EQ(talk.force_limit, 40.0);
    EXPECT_TRUE(talk.ready());
    EXPECT_EQ(talk.safeties.back().state, SafetyState::normal);
    EXPECT_NEAR(talk.state.width, 0.05, 1e-9);
}

TEST(ConversationBegin, SetsTheAccelerationIfItIsGiven) {
    Talk talk({.acceleration = 2.0});
    talk.start();
    EXPECT_THAT(talk.sentIds(), ElementsAre(0x53, 0x33, 0x30, 0x40, 0x41, 0x43, 0x45));
    EXPECT_EQ(talk.sent[2], frame(0x30, f32(2000)));
}

TEST(ConversationBegin, DoesWithoutTheForceLimitOfTheGripper) {
    Talk talk;
    talk.hear(limits());
    talk.hear(reply(0x33, 14));
    talk.hear(systemState(kReferenced) + graspingState(kIdle) + width(50) + force(0));
    EXPECT_TRUE(talk.ready());
    EXPECT_EQ(talk.force_limit, 80.0);
}

TEST(ConversationBegin, DoesWithoutAForceLimitThatIsNone) {
    for (const auto& data : {f32(0), f32(-1), bytes({1, 2})}) {
        Talk talk;
        talk.hear(limits());
        talk.hear(reply(0x33, kSuccess, data));
        talk.hear(systemState(kReferenced) + graspingState(kIdle) + width(50) + force(0));
        EXPECT_TRUE(talk.ready());
        EXPECT_EQ(talk.force_limit, 80.0);
    }
}

TEST(ConversationBegin, EndsWhenAReplyHasNoStatus) {
    Talk talk;
    talk.hear(frame(0x53, {}));
    ASSERT_TRUE(talk.error);
    EXPECT_THAT(talk.error->message, HasSubstr("reply 53: no status"));
}

TEST(ConversationBegin, EndsIfTheGripperRefusesALimitOrAnUpdate) {
    Talk no_limits;
    no_limits.hear(reply(0x53, 14));
    EXPECT_THAT(no_limits.error->message, HasSubstr("53: unknown command (status 14)"));
    Talk no_updates;
    no_updates.hear(limits() + reply(0x33, kSuccess, f32(40)) + reply(0x40, 5));
    EXPECT_THAT(no_updates.error->message, HasSubstr("feature not supported"));
}

TEST(ConversationBegin, EndsWithoutAnAnswer) {
    Talk talk;
    talk.wait(999ms);
    EXPECT_FALSE(talk.error);
    talk.wait(1ms);
    EXPECT_THAT(talk.error->message, HasSubstr("no answer to command 53 within 1000 ms"));
}

TEST(ConversationBegin, SkipsWhatItDidNotAskFor) {
    Talk talk;
    talk.hear(systemState(kReferenced) + width(3) + reply(0x25, kAborted));
    EXPECT_THAT(talk.sentIds(), ElementsAre(0x53));
    talk.start();
    EXPECT_TRUE(talk.ready());
}

TEST(ConversationBegin, ShowsAFaultThatIsThereAndDoesNotAcknowledgeIt) {
    Talk talk;
    talk.start(kReferenced | kFastStop);
    EXPECT_FALSE(talk.ready());
    EXPECT_EQ(talk.safeties.back().state, SafetyState::fault);
    EXPECT_THAT(talk.safeties.back().text, HasSubstr("fast stop"));
    EXPECT_THAT(talk.sentIds(), ElementsAre(0x53, 0x33, 0x40, 0x41, 0x43, 0x45));
}

TEST(ConversationBegin, AcknowledgesAFaultIfItIsToldTo) {
    Talk talk({.acknowledge = true});
    talk.start(kReferenced | kFastStop);
    EXPECT_EQ(talk.sent.back(), frame(0x24, text("ack")));
    talk.hear(reply(0x24, kSuccess));
    talk.update(kReferenced, kIdle, 50);
    EXPECT_TRUE(talk.ready());
}

TEST(ConversationBegin, AcknowledgesNothingWithoutAFault) {
    Talk talk({.acknowledge = true});
    talk.start();
    EXPECT_TRUE(talk.ready());
    EXPECT_EQ(talk.sentIds().back(), 0x45);
    EXPECT_THAT(talk.resets, IsEmpty());
}

TEST(ConversationBegin, AcknowledgesAndThenHomesIfItIsToldTo) {
    Talk talk({.acknowledge = true, .home = true});
    talk.start(kFastStop);
    EXPECT_EQ(talk.sentIds().back(), 0x24);
    talk.hear(reply(0x24, kSuccess));
    talk.update(0, kIdle, 50);
    EXPECT_EQ(talk.sentIds().back(), 0x20);
}

TEST(ConversationBegin, DoesNotMoveAGripperThatIsNotReferenced) {
    Talk talk;
    talk.start(0);
    EXPECT_FALSE(talk.ready());
    EXPECT_THAT(talk.safeties.back().text, HasSubstr("not referenced: Reset homes it"));
    EXPECT_EQ(talk.sentIds().back(), 0x45);
}

TEST(ConversationBegin, HomesIfItIsToldTo) {
    Talk talk({.home = true});
    talk.start(0);
    EXPECT_EQ(talk.sent.back(), frame(0x20, bytes({0})));
    EXPECT_THAT(talk.safeties.back().text, HasSubstr("homing"));
    talk.hear(reply(0x20, kPending));
    talk.pass(1s, kMoving, 6, 20);
    talk.hear(reply(0x20, kSuccess));
    talk.update(kReferenced, kIdle, 110);
    EXPECT_TRUE(talk.ready());
}

TEST(ConversationBegin, DoesNotHomeAFaultedGripper) {
    Talk talk({.home = true});
    talk.start(kFastStop);
    EXPECT_EQ(talk.sentIds().back(), 0x45);
}

struct Ready : ::testing::Test {
    Ready() {
        talk.start();
        talk.sent.clear();
    }
    Talk talk;
};

using Reset = Ready;

TEST_F(Reset, AcknowledgesAndTellsTheEndOnceTheStateAgrees) {
    talk.update(kReferenced | kFastStop, kIdle, 50);
    EXPECT_EQ(talk.safeties.back().state, SafetyState::fault);
    talk.reset();
    EXPECT_THAT(talk.sentIds(), ElementsAre(0x24));
    talk.hear(reply(0x24, kSuccess));
    EXPECT_THAT(talk.resets, IsEmpty()) << "an acknowledgement is not the state";
    talk.update(kReferenced, kIdle, 50);
    ASSERT_EQ(talk.resets.size(), 1U);
    EXPECT_TRUE(talk.resets[0]);
    EXPECT_TRUE(talk.ready());
}

TEST_F(Reset, FailsIfTheFaultStays) {
    talk.update(kReferenced | kFastStop, kIdle, 50);
    talk.reset();
    talk.hear(reply(0x24, kSuccess));
    talk.pass(1s, kReferenced | kFastStop, kIdle, 50);
    ASSERT_EQ(talk.resets.size(), 1U);
    EXPECT_THAT(talk.resets[0].error().message, HasSubstr("still: fast stop"));
    EXPECT_FALSE(talk.ready());
}

TEST_F(Reset, FailsIfItIsRefused) {
    talk.update(kReferenced | kFastStop, kIdle, 50);
    talk.reset();
    talk.hear(reply(0x24, kAccessDenied));
    ASSERT_EQ(talk.resets.size(), 1U);
    EXPECT_THAT(talk.resets[0].error().message, HasSubstr("access denied"));
}

TEST_F(Reset, HomesAGripperThatLostItsReference) {
    talk.update(kFastStop, kIdle, 50);
    talk.reset();
    talk.hear(reply(0x24, kSuccess));
    talk.update(0, kIdle, 50);
    EXPECT_THAT(talk.sentIds(), ElementsAre(0x24, 0x20));
    talk.hear(reply(0x20, kPending));
    talk.reset();
    EXPECT_THAT(talk.sentIds(), ElementsAre(0x24, 0x20)) << "once is enough";
    talk.hear(reply(0x20, kSuccess));
    talk.update(kReferenced, kIdle, 110);
    ASSERT_EQ(talk.resets.size(), 1U);
    EXPECT_TRUE(talk.resets[0]);
    EXPECT_THAT(talk.ends, IsEmpty()) << "nobody asked for that motion";
}

TEST_F(Reset, TellsThatHomingFailed) {
    talk.update(0, kIdle, 50);
    talk.reset();
    talk.hear(reply(0x20, kPending) + reply(0x20, kBlocked));
    talk.update(0, kIdle, 48);
    ASSERT_EQ(talk.resets.size(), 1U);
    EXPECT_THAT(talk.resets[0].error().message, HasSubstr("homing blocked at 48.0 mm"));
    EXPECT_THAT(talk.safeties.back().text, HasSubstr("not referenced"));
}

TEST_F(Reset, WaitsForTheEndOfAMotionAndTellsTheFaultThatItEndedWith) {
    talk.begin(kMove);
    talk.hear(reply(0x32, kSuccess) + reply(0x21, kPending));
    talk.reset();
    talk.pass(2s, kReferenced | kMoving, 6, 55);
    EXPECT_THAT(talk.resets, IsEmpty());
    talk.update(kReferenced | kFastStop, kIdle, 55);
    ASSERT_EQ(talk.resets.size(), 1U);
    EXPECT_EQ(talk.resets[0].error().message, "fast stop");
    EXPECT_EQ(talk.motionError(), "move ended by the gripper: fast stop");
    EXPECT_THAT(talk.sentIds(), ElementsAre(0x32, 0x21)) << "nobody asked since the fault";
}

TEST_F(Reset, IsNotEndedByTheReplyToSomethingElse) {
    talk.update(kReferenced | kFastStop, kIdle, 50);
    talk.reset();
    talk.hear(reply(0x22, kAccessDenied));
    EXPECT_THAT(talk.resets, IsEmpty());
    talk.hear(reply(0x24, kSuccess));
    talk.update(kReferenced, kIdle, 50);
    ASSERT_EQ(talk.resets.size(), 1U);
    EXPECT_TRUE(talk.resets[0]);
}

TEST_F(Reset, OfAHealthyGripperSaysSoAtOnce) {
    talk.reset();
    EXPECT_EQ(talk.resets.size(), 1U);
    EXPECT_THAT(talk.sent, IsEmpty());
}

using Silence = Ready;

TEST_F(Silence, OfThreePeriodsEndsTheConversation) {
    talk.wait(60ms);
    EXPECT_FALSE(talk.error);
    talk.wait(1ms);
    EXPECT_EQ(talk.error->code, Errc::timeout);
    EXPECT_THAT(talk.error->message, HasSubstr("no update of the system state for 60 ms"));
}

TEST_F(Silence, OfOneValueAloneIsEnough) {
    for (int i = 0; i < 4; ++i) {
        talk.wait(20ms);
        talk.hear(systemState(kReferenced) + graspingState(kIdle) + force(0));
    }
    EXPECT_THAT(talk.error->message, HasSubstr("no update of the width"));
}

TEST_F(Ready, EndsWhenAnUpdateMakesNoSense) {
    talk.hear(reply(0x43, kSuccess, bytes({1, 2})));
    EXPECT_THAT(talk.error->message, HasSubstr("width: 2 bytes, expected 4"));
}

TEST_F(Ready, TellsAPartThatIsLostInTheState) {
    talk.update(kReferenced, kHolding, 30, 20);
    EXPECT_TRUE(talk.state.part_held);
    EXPECT_NEAR(talk.state.force, 20.0, 1e-9);
    talk.update(kReferenced, kPartLost, 12);
    EXPECT_FALSE(talk.state.part_held);
    EXPECT_TRUE(talk.ready()) << "it is no change of the safety state";
}

}  // namespace
}  // namespace metier::wsg50_driver::testing
