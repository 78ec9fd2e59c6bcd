#include <gmock/gmock.h>

#include "talk.hpp"

namespace metier::wsg50_driver::testing {
namespace {

using namespace std::chrono_literals;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class MotionOf : public ::testing::Test {
protected:
    MotionOf() {
        talk.start();
        talk.sent.clear();
    }

    /// Up to the moment when the gripper moves.
    void underWay(const Motion& motion, int id) {
        talk.begin(motion);
        talk.hear(reply(0x32, kSuccess));
        talk.hear(reply(id, kPending));
        talk.pass(60ms, kReferenced | kMoving, kIdle, 45);
        ASSERT_THAT(talk.ends, IsEmpty());
        EXPECT_TRUE(talk.state.moving);
    }

    Talk talk;
};

TEST_F(MotionOf, GraspSetsTheForceLimitFirst) {
    talk.begin(kGrasp);
    ASSERT_EQ(talk.sent.size(), 1U);
    EXPECT_EQ(talk.sent[0], frame(0x32, f32(20)));
    talk.hear(reply(0x32, kSuccess));
    ASSERT_EQ(talk.sent.size(), 2U);
    EXPECT_EQ(talk.sent[1], frame(0x25, f32(30) + f32(50)));
    EXPECT_FALSE(talk.ready()) << "one motion at a time";
}

TEST_F(MotionOf, GraspEndsWithThePartOnceTheStateAgrees) {
    underWay(kGrasp, 0x25);
    talk.hear(reply(0x25, kSuccess));
    EXPECT_THAT(talk.ends, IsEmpty()) << "a reply alone is not trusted";
    talk.update(kReferenced, kHolding, 29.5F, 20);
    ASSERT_EQ(talk.ends.size(), 1U);
    ASSERT_TRUE(talk.ends[0]);
    EXPECT_TRUE(talk.ends[0]->part_held);
    EXPECT_NEAR(talk.ends[0]->width, 0.0295, 1e-6);
}

TEST_F(MotionOf, GraspWaitsUntilTheStateFollowsItsLastReply) {
    underWay(kGrasp, 0x25);
    talk.hear(reply(0x25, kSuccess));
    talk.pass(100ms, kReferenced, 1, 30);
    EXPECT_THAT(talk.ends, IsEmpty());
    talk.update(kReferenced, kHolding, 30, 20);
    ASSERT_EQ(talk.ends.size(), 1U);
    EXPECT_TRUE(talk.ends[0]);
}

TEST_F(MotionOf, GraspWithoutAPartTellsHowFarTheJawsClosed) {
    underWay(kGrasp, 0x25);
    talk.hear(reply(0x25, kFailed));
    talk.update(kReferenced, kNoPart, 0.0F);
    EXPECT_EQ(talk.motionCode(), Errc::device_fault);
    EXPECT_EQ(talk.motionError(), "no part found: the jaws closed to 0.0 mm");
}

TEST_F(MotionOf, GraspThatSaysSuccessWithoutAPartFails) {
    underWay(kGrasp, 0x25);
    talk.hear(reply(0x25, kSuccess));
    talk.pass(300ms, kReferenced, kNoPart, 12);
    EXPECT_EQ(talk.motionError(), "no part found: the jaws closed to 12.0 mm");
}

TEST_F(MotionOf, GraspWhoseStateNeverAgreesFails) {
    underWay(kGrasp, 0x25);
    talk.hear(reply(0x25, kSuccess));
    talk.pass(300ms, kReferenced, kIdle, 30);
    EXPECT_THAT(talk.motionError(),
                HasSubstr("reported success of grasp, but its state is 'idle'"));
}

TEST_F(MotionOf, GraspTellsThatThePartWasLostOnTheWay) {
    underWay(kGrasp, 0x25);
    talk.hear(reply(0x25, kFailed));
    talk.update(kReferenced, kPartLost, 3);
    EXPECT_THAT(talk.motionError(), HasSubstr("the part was lost at 3.0 mm"));
}

TEST_F(MotionOf, GraspThatIsBlockedByAPartHoldsIt) {
    underWay(kGrasp, 0x25);
    talk.hear(reply(0x25, kBlocked));
    talk.update(kReferenced, kHolding, 41, 20);
    ASSERT_EQ(talk.ends.size(), 1U);
    EXPECT_TRUE(talk.ends[0]);
}

TEST_F(MotionOf, GraspThatIsBlockedAndHoldsNothingFails) {
    underWay(kGrasp, 0x25);
    talk.hear(reply(0x25, kBlocked));
    talk.update(kReferenced, kNoPart, 41);
    EXPECT_THAT(talk.motionError(), HasSubstr("grasp blocked at 41.0 mm"));
}

TEST_F(MotionOf, GraspOfAnyWidthIsRepeatedAtTheWidthThatBlockedIt) {
    underWay({MotionKind::grasp, 0.0, 0.05, 20.0, true}, 0x25);
    talk.hear(reply(0x25, kBlocked));
    talk.update(kReferenced, kIdle, 41);
    EXPECT_THAT(talk.ends, IsEmpty());
    EXPECT_EQ(talk.sent.back(), frame(0x25, f32(41) + f32(50)));
    talk.hear(reply(0x25, kPending) + reply(0x25, kSuccess));
    talk.update(kReferenced, kHolding, 41, 20);
    ASSERT_EQ(talk.ends.size(), 1U);
    EXPECT_TRUE(talk.ends[0]);
}

TEST_F(MotionOf, GraspOfAnyWidthIsRepeatedOnce) {
    underWay({MotionKind::grasp, 0.0, 0.05, 20.0, true}, 0x25);
    talk.hear(reply(0x25, kBlocked));
    talk.update(kReferenced, kIdle, 41);
    talk.hear(reply(0x25, kBlocked));
    talk.update(kReferenced, kIdle, 41);
    EXPECT_THAT(talk.motionError(), HasSubstr("grasp blocked at 41.0 mm"));
}

TEST_F(MotionOf, GraspOfAnyWidthIsNotRepeatedAfterAStop) {
    underWay({MotionKind::grasp, 0.0, 0.05, 20.0, true}, 0x25);
    talk.stop();
    talk.hear(reply(0x25, kBlocked));
    talk.update(kReferenced, kIdle, 41);
    EXPECT_EQ(talk.motionCode(), Errc::cancelled);
}

TEST_F(MotionOf, GraspOfAnyWidthThatHoldsThePartIsNotRepeated) {
    underWay({MotionKind::grasp, 0.0, 0.05, 20.0, true}, 0x25);
    talk.hear(reply(0x25, kBlocked));
    talk.update(kReferenced, kHolding, 41, 20);
    ASSERT_EQ(talk.ends.size(), 1U);
    EXPECT_TRUE(talk.ends[0]);
    EXPECT_THAT(talk.sentIds(), ElementsAre(0x32, 0x25));
}

TEST_F(MotionOf, GraspOfAnyWidthThatFailedIsNotRepeated) {
    underWay({MotionKind::grasp, 0.0, 0.05, 20.0, true}, 0x25);
    talk.hear(reply(0x25, kFailed));
    talk.update(kReferenced, kNoPart, 0);
    EXPECT_THAT(talk.motionError(), HasSubstr("no part found"));
    EXPECT_THAT(talk.sentIds(), ElementsAre(0x32, 0x25));
}

TEST_F(MotionOf, GraspThatSaysSuccessButLostThePartFails) {
    underWay(kGrasp, 0x25);
    talk.hear(reply(0x25, kSuccess));
    talk.pass(300ms, kReferenced, kPartLost, 12);
    EXPECT_EQ(talk.motionError(), "the part was lost at 12.0 mm");
}

TEST_F(MotionOf, ReleaseThatFailsTellsWhere) {
    underWay(kRelease, 0x26);
    talk.hear(reply(0x26, kFailed));
    talk.update(kReferenced, kIdle, 42);
    EXPECT_EQ(talk.motionError(), "release failed at 42.0 mm");
}

TEST_F(MotionOf, ReleaseEndsWhenThePartIsFree) {
    underWay(kRelease, 0x26);
    EXPECT_EQ(talk.sent.back(), frame(0x26, f32(80) + f32(100)));
    talk.hear(reply(0x26, kSuccess));
    talk.update(kReferenced, kReleasing, 80);
    EXPECT_THAT(talk.ends, IsEmpty());
    talk.update(kReferenced, kIdle, 80);
    ASSERT_EQ(talk.ends.size(), 1U);
    EXPECT_FALSE(talk.ends[0]->part_held);
}

TEST_F(MotionOf, ReleaseThatStillHoldsThePartFails) {
    underWay(kRelease, 0x26);
    talk.hear(reply(0x26, kSuccess));
    talk.pass(300ms, kReferenced, kHolding, 30);
    EXPECT_THAT(talk.motionError(), HasSubstr("'holding'"));
}

TEST_F(MotionOf, MoveEndsAtItsWidth) {
    underWay(kMove, 0x21);
    talk.hear(reply(0x21, kSuccess));
    talk.update(kReferenced, kIdle, 60.2F);
    ASSERT_EQ(talk.ends.size(), 1U);
    EXPECT_TRUE(talk.ends[0]);
}

TEST_F(MotionOf, MoveThatSaysSuccessElsewhereFails) {
    underWay(kMove, 0x21);
    talk.hear(reply(0x21, kSuccess));
    talk.pass(300ms, kReferenced, kIdle, 50);
    EXPECT_THAT(talk.motionError(), HasSubstr("at 50.0 mm instead of 60.0 mm"));
}

TEST_F(MotionOf, MoveThatIsBlockedTellsWhere) {
    underWay(kMove, 0x21);
    talk.hear(reply(0x21, kBlocked));
    talk.update(kReferenced, kIdle, 52);
    EXPECT_EQ(talk.motionError(), "move blocked at 52.0 mm");
}

TEST_F(MotionOf, MoveThatSomeoneElseAbortedTellsSo) {
    underWay(kMove, 0x21);
    talk.hear(reply(0x21, kAborted));
    talk.update(kReferenced, kIdle, 52);
    EXPECT_THAT(talk.motionError(), HasSubstr("aborted by someone else at 52.0 mm"));
}

TEST_F(MotionOf, MoveWithoutAPendingReplyIsTaken) {
    talk.begin(kMove);
    talk.hear(reply(0x32, kSuccess) + reply(0x21, kSuccess));
    talk.update(kReferenced, kIdle, 60);
    ASSERT_EQ(talk.ends.size(), 1U);
    EXPECT_TRUE(talk.ends[0]);
}

TEST_F(MotionOf, RepliesToOthersAndUpdatesInBetweenAreSkipped) {
    talk.begin(kMove);
    talk.hear(reply(0x25, kFailed) + width(50) + reply(0x50, kSuccess, bytes({1, 2, 3, 4})));
    talk.hear(reply(0x32, kSuccess) + graspingState(6) + reply(0x21, kPending) + width(55));
    talk.hear(reply(0x26, kSuccess) + reply(0x25, kSuccess) + systemState(kReferenced));
    EXPECT_THAT(talk.ends, IsEmpty());
    talk.hear(reply(0x21, kSuccess));
    talk.update(kReferenced, kIdle, 60);
    EXPECT_EQ(talk.ends.size(), 1U);
}

TEST_F(MotionOf, AnyKindTellsWhyItIsRefused) {
    talk.begin(kMove);
    talk.hear(reply(0x32, kSuccess) + reply(0x21, kRangeError));
    EXPECT_EQ(talk.motionError(), "move refused: range error (status 28)");
    EXPECT_TRUE(talk.ready());
}

TEST_F(MotionOf, AnyKindTellsThatTheForceLimitIsRefused) {
    talk.begin(kGrasp);
    talk.hear(reply(0x32, kRangeError));
    EXPECT_EQ(talk.motionError(), "force limit of 20 N refused: range error (status 28)");
    EXPECT_THAT(talk.sentIds(), ElementsAre(0x32));
}

TEST_F(MotionOf, AnyKindWithoutAnAnswerFails) {
    talk.begin(kGrasp);
    talk.pass(1s, kReferenced, kIdle, 50);
    EXPECT_EQ(talk.motionCode(), Errc::timeout);
    EXPECT_THAT(talk.motionError(), HasSubstr("no answer to grasp"));
}

TEST_F(MotionOf, AnyKindThatDoesNotEndIsStopped) {
    underWay(kMove, 0x21);
    talk.pass(30s, kReferenced | kMoving, kIdle, 50);
    EXPECT_EQ(talk.sentIds().back(), 0x22);
    talk.hear(reply(0x22, kSuccess) + reply(0x21, kAborted));
    talk.update(kReferenced, kIdle, 50);
    EXPECT_EQ(talk.motionCode(), Errc::timeout);
    EXPECT_EQ(talk.motionError(), "move did not end in time");
}

TEST_F(MotionOf, AnyKindEndsWithAFault) {
    underWay(kMove, 0x21);
    talk.hear(systemState(kReferenced | kFastStop));
    EXPECT_EQ(talk.motionError(), "move ended by the gripper: fast stop");
    EXPECT_FALSE(talk.ready());
}

TEST_F(MotionOf, StopEndsItAsCancelled) {
    underWay(kMove, 0x21);
    talk.stop();
    talk.stop();
    EXPECT_THAT(talk.sentIds(), ElementsAre(0x32, 0x21, 0x22));
    talk.hear(reply(0x22, kSuccess));
    EXPECT_THAT(talk.ends, IsEmpty());
    talk.hear(reply(0x21, kAborted));
    talk.update(kReferenced, kIdle, 50);
    EXPECT_EQ(talk.motionCode(), Errc::cancelled);
}

TEST_F(MotionOf, StopEndsItOnceTheJawsRest) {
    // The gripper reports the end of the motion when it begins to brake. Halted was published then,
    // and the next motion was refused: the jaws still moved.
    underWay(kMove, 0x21);
    talk.stop();
    talk.hear(reply(0x22, kSuccess) + reply(0x21, kAborted));
    talk.pass(500ms, kReferenced | kMoving, kIdle, 47);
    EXPECT_THAT(talk.ends, IsEmpty());
    talk.update(kReferenced, kIdle, 46);
    EXPECT_EQ(talk.motionCode(), Errc::cancelled);
    EXPECT_FALSE(talk.state.moving);
}

TEST_F(MotionOf, AnyKindWhoseJawsMoveOnAfterItsEndIsTold) {
    underWay(kMove, 0x21);
    talk.hear(reply(0x21, kAborted));
    talk.pass(31s, kReferenced | kMoving, kIdle, 47);
    EXPECT_EQ(talk.motionCode(), Errc::timeout);
    EXPECT_EQ(talk.motionError(), "the jaws still move after the end of move");
}

TEST_F(MotionOf, StopBeforeTheMotionBeganSendsNone) {
    talk.begin(kMove);
    talk.stop();
    talk.hear(reply(0x32, kSuccess));
    talk.update(kReferenced, kIdle, 50);
    EXPECT_EQ(talk.motionCode(), Errc::cancelled);
    EXPECT_THAT(talk.sentIds(), ElementsAre(0x32));
}

TEST_F(MotionOf, StopEndsItSoonAlsoIfTheMotionIsToldToBeginOnlyThen) {
    talk.begin(kMove);
    talk.hear(reply(0x32, kSuccess));
    talk.stop();
    talk.hear(reply(0x21, kPending));
    talk.pass(1s, kReferenced, kIdle, 50);
    ASSERT_EQ(talk.ends.size(), 1U) << "not only after the time that a motion may take";
    EXPECT_EQ(talk.motionCode(), Errc::cancelled);
}

TEST_F(MotionOf, StopAfterItsLastReplySendsNone) {
    underWay(kMove, 0x21);
    talk.hear(reply(0x21, kSuccess));
    talk.stop();
    EXPECT_THAT(talk.sentIds(), ElementsAre(0x32, 0x21));
    talk.update(kReferenced, kIdle, 60);
    ASSERT_EQ(talk.ends.size(), 1U);
    EXPECT_TRUE(talk.ends[0]);
}

TEST_F(MotionOf, StopWithoutAMotionSendsNothing) {
    talk.stop();
    EXPECT_THAT(talk.sent, IsEmpty());
}

TEST_F(MotionOf, MoveEndsWithinAMillimetreOfItsWidth) {
    underWay(kMove, 0x21);
    talk.hear(reply(0x21, kSuccess));
    talk.update(kReferenced, kIdle, 61.01F);
    EXPECT_THAT(talk.ends, IsEmpty());
    talk.update(kReferenced, kIdle, 59.01F);
    ASSERT_EQ(talk.ends.size(), 1U);
    EXPECT_TRUE(talk.ends[0]);
}

TEST_F(MotionOf, StopThatComesTooLateLeavesTheSuccess) {
    underWay(kGrasp, 0x25);
    talk.stop();
    talk.hear(reply(0x25, kSuccess) + reply(0x22, kSuccess));
    talk.update(kReferenced, kHolding, 30, 20);
    ASSERT_EQ(talk.ends.size(), 1U);
    EXPECT_TRUE(talk.ends[0]);
}

TEST_F(MotionOf, StopWithoutALastReplyIsJudgedByTheState) {
    underWay(kMove, 0x21);
    talk.stop();
    talk.pass(1s, kReferenced, kIdle, 50);
    EXPECT_EQ(talk.motionCode(), Errc::cancelled);
}

TEST_F(MotionOf, StopThatDoesNotStopIsTold) {
    underWay(kMove, 0x21);
    talk.stop();
    talk.pass(1s, kReferenced | kMoving, kIdle, 50);
    EXPECT_EQ(talk.motionCode(), Errc::timeout);
    EXPECT_THAT(talk.motionError(), HasSubstr("still move"));
}

TEST_F(MotionOf, ALateLastReplyIsNotTakenForTheNextMotion) {
    underWay(kMove, 0x21);
    talk.stop();
    talk.pass(1s, kReferenced, kIdle, 50);
    talk.ends.clear();
    talk.begin(kMove);
    talk.hear(reply(0x32, kSuccess) + reply(0x21, kAborted) + reply(0x21, kPending));
    talk.update(kReferenced | kMoving, kIdle, 55);
    EXPECT_THAT(talk.ends, IsEmpty());
    talk.hear(reply(0x21, kSuccess));
    talk.update(kReferenced, kIdle, 60);
    ASSERT_EQ(talk.ends.size(), 1U);
    EXPECT_TRUE(talk.ends[0]);
}

TEST_F(MotionOf, ALastReplyThatNeverCameIsNotMissedLater) {
    underWay(kMove, 0x21);
    talk.stop();
    talk.pass(1s, kReferenced, kIdle, 50);
    talk.ends.clear();
    underWay(kMove, 0x21);
    talk.hear(reply(0x21, kSuccess));
    talk.update(kReferenced, kIdle, 60);
    ASSERT_EQ(talk.ends.size(), 1U);
    EXPECT_TRUE(talk.ends[0]);
}

}  // namespace
}  // namespace metier::wsg50_driver::testing
