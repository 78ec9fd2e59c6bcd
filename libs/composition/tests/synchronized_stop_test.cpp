#include "synchronized_bench.hpp"

namespace metier::composition {
namespace {

using skill::Reason;
using skill::State;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

class SynchronizedStop : public ::testing::Test {
protected:
    SynchronizedStop() {
        bench.startBoth();
        static_cast<void>(bench["left"].joint->heard());
        static_cast<void>(bench["right"].joint->heard());
    }

    ScriptedUsedSkill& left() { return *bench["left"].joint; }
    ScriptedUsedSkill& right() { return *bench["right"].joint; }
    void run() { bench.run(); }
    void suspendBoth() {
        EXPECT_TRUE(bench.call(bench.program->suspend(kClient)));
        left().suspended();
        run();
        EXPECT_EQ(bench.state(), "Running") << "the other still moves";
        right().suspended();
        run();
        EXPECT_EQ(bench.state(), "Suspended");
        static_cast<void>(left().heard());
        static_cast<void>(right().heard());
    }
    /// A suspended execution that was reset.
    void given(ScriptedUsedSkill& used) {
        used.state_now = State::ready;
        used.listener->onEnd(
            {composition::UsedSkillEnd::Kind::halted, {}, Reason::by_client, "reset"});
        run();
    }

    Bench bench;
};

TEST_F(SynchronizedStop, OneThatIsHaltedHaltsTheOther) {
    left().halted(Reason::by_client, "a client called Halt");
    run();
    EXPECT_THAT(right().heard(), ElementsAre("halt"));
    EXPECT_EQ(bench.state(), "Running") << "until the other stands";
    right().halted();
    run();
    EXPECT_EQ(bench.state(), "Halted");
    EXPECT_THAT(bench.why(), HasSubstr("left was Halted"));
    EXPECT_THAT(bench.why(), HasSubstr("a client called Halt"));
}

TEST_F(SynchronizedStop, OneThatBrakesForAHaltHaltsTheOtherBeforeItStands) {
    left().stops(State::halted, "by a panel");
    run();
    EXPECT_THAT(right().heard(), ElementsAre("halt"));
    EXPECT_THAT(left().heard(), IsEmpty());
    right().halted();
    run();
    EXPECT_EQ(bench.state(), "Running") << "until both stand";
    left().halted(Reason::by_client);
    run();
    EXPECT_EQ(bench.state(), "Halted");
    EXPECT_EQ(bench.why(), "left was Halted (ByClient): by a panel");
    ASSERT_TRUE(bench.call(bench.program->reset(kClient)));
    EXPECT_THAT(left().heard(), IsEmpty()) << "a client has halted it";
    EXPECT_THAT(right().heard(), ElementsAre("reset"));
}

TEST_F(SynchronizedStop, OneThatIsLostHaltsTheOther) {
    right().listener->onEnd(
        {composition::UsedSkillEnd::Kind::lost, {}, Reason::device_lost, "gone"});
    run();
    EXPECT_THAT(left().heard(), ElementsAre("halt"));
    left().halted();
    run();
    EXPECT_EQ(bench.state(), "Halted");
    EXPECT_EQ(bench.program->reason(), Reason::device_lost);
    EXPECT_EQ(bench.why(), "right is lost: gone");
}

TEST_F(SynchronizedStop, OneThatRefusesToStartHaltsTheOther) {
    right().refused("the arm still moves");
    run();
    EXPECT_THAT(left().heard(), ElementsAre("halt"));
    left().halted();
    run();
    EXPECT_EQ(bench.why(), "right refused Start: the arm still moves");
}

TEST_F(SynchronizedStop, OneThatHasNotBegunInTimeHaltsTheOther) {
    right().state_now = State::ready;
    bench.executor->advance(374ms);
    EXPECT_THAT(left().heard(), IsEmpty());
    bench.executor->advance(2ms);
    EXPECT_THAT(left().heard(), ElementsAre("halt"));
    EXPECT_THAT(right().heard(), ElementsAre("halt"));
    left().halted();
    right().halted();
    run();
    EXPECT_THAT(bench.why(), HasSubstr("right did not begin in time"));
}

TEST_F(SynchronizedStop, HaltReachesBoth) {
    ASSERT_TRUE(bench.call(bench.program->halt(kClient)));
    EXPECT_THAT(left().heard(), ElementsAre("halt"));
    EXPECT_THAT(right().heard(), ElementsAre("halt"));
    left().halted();
    run();
    EXPECT_EQ(bench.state(), "Running");
    right().halted();
    run();
    EXPECT_EQ(bench.state(), "Halted");
    EXPECT_EQ(bench.program->reason(), Reason::by_client);
}

TEST_F(SynchronizedStop, OneThatDoesNotComeToRestIsNamed) {
    left().halted(Reason::error, "protective stop");
    run();
    bench.executor->advance(kRestTime);
    EXPECT_EQ(bench.state(), "Halted");
    EXPECT_EQ(bench.why(),
              "left was Halted (Error): protective stop; right did not come to rest within 6 s "
              "after Halt");
}

TEST_F(SynchronizedStop, WhatWasHaltedHereIsResetHereAndNothingElse) {
    left().halted(Reason::by_client);
    run();
    right().halted();
    run();
    static_cast<void>(right().heard());
    ASSERT_TRUE(bench.call(bench.program->reset(kClient)));
    EXPECT_THAT(right().heard(), ElementsAre("reset"));
    EXPECT_THAT(left().heard(), IsEmpty());
    EXPECT_EQ(bench.state(), "Ready");
    ASSERT_TRUE(bench.program->startWith(kClient, {"again", Bench::twoPoses()}));
    run();
    EXPECT_THAT(right().heard(), ElementsAre("reset")) << "it is still Halted";
    EXPECT_THAT(left().heard(), IsEmpty());
    EXPECT_THAT(bench["left"].pose->heard(), ElementsAre("check")) << "of the first run";
    right().wasReset();
    run();
    EXPECT_THAT(bench["left"].pose->heard(), ElementsAre("check")) << "it tells that it is Halted";
}

TEST_F(SynchronizedStop, SuspendReachesBothAndResumeBeginsAnewTogether) {
    suspendBoth();
    ASSERT_TRUE(bench.call(bench.program->resume(kClient)));
    EXPECT_EQ(bench.state(), "Running");
    EXPECT_THAT(left().heard(), ElementsAre("reset"));
    EXPECT_THAT(right().heard(), ElementsAre("reset"));
    given(left());
    given(right());
    EXPECT_THAT(left().heard(), ElementsAre("check"));
    EXPECT_EQ(left().checked.at("TargetJointPosition"), skill::Value(std::vector<double>{1.0}));
    bench.answerCheck("left", 0.5, 0.75, 1.0);
    bench.answerCheck("right", 1.5, -0.5, -1.0);
    bench.answerClocks("left", 0ns, 1ms);
    bench.answerClocks("right", 0ns, 1ms);
    EXPECT_EQ(bench.requested("left", "Duration"), 1.5) << "what is left for the slower one";
    bench.finish("left", 200.0, 201.5);
    bench.finish("right", 200.0, 201.5);
    EXPECT_EQ(bench.state(), "Ready");
}

TEST_F(SynchronizedStop, ResumeFailsIfAnArmWasMovedOffItsWay) {
    suspendBoth();
    ASSERT_TRUE(bench.call(bench.program->resume(kClient)));
    given(left());
    given(right());
    bench.answerCheck("left", 0.5, -0.02, 1.0);
    EXPECT_EQ(bench.state(), "Halted");
    EXPECT_EQ(bench.why(), "left was moved off its way: axis 1 by 0.0200 rad, limit 0.002 rad");
    EXPECT_THAT(right().heard(), Not(Contains("begin")));
}

TEST_F(SynchronizedStop, OneThatSomebodySuspendsSuspendsTheOtherBeforeItStandsAndThenTheWhole) {
    left().stops(State::suspended, "by a panel");
    run();
    EXPECT_THAT(right().heard(), ElementsAre("suspend"));
    EXPECT_EQ(bench.program->subState(), skill::SubState::stopping);
    left().suspended();
    run();
    EXPECT_EQ(bench.state(), "Running") << "the other still moves";
    right().suspended();
    run();
    EXPECT_EQ(bench.state(), "Suspended");
    EXPECT_EQ(bench.why(), "left was suspended by a panel");
    EXPECT_EQ(bench.program->reason(), Reason::by_client);
    EXPECT_THAT(left().heard(), IsEmpty());
    ASSERT_TRUE(bench.call(bench.program->resume(kClient)));
    EXPECT_THAT(left().heard(), ElementsAre("reset"));
    EXPECT_THAT(right().heard(), ElementsAre("reset"));
}

TEST_F(SynchronizedStop, OneWhoseServerDoesNotSayThatItBrakesSuspendsAllOnceItStands) {
    left().suspended();
    run();
    EXPECT_THAT(right().heard(), ElementsAre("suspend"));
    right().suspended();
    run();
    EXPECT_EQ(bench.state(), "Suspended");
    EXPECT_EQ(bench.why(), "left was suspended");
}

TEST_F(SynchronizedStop, SkewsAfterAResumeAreThoseOfTheArmsThatWentOn) {
    bench.finish("left", 100.0, 103.0);
    ASSERT_TRUE(bench.call(bench.program->suspend(kClient)));
    right().suspended();
    run();
    ASSERT_TRUE(bench.call(bench.program->resume(kClient)));
    given(right());
    bench.answerCheck("right", 1.5, -0.5, -1.0);
    bench.answerClocks("right", 0ns, 1ms);
    bench.finish("right", 112.8, 114.3);
    EXPECT_EQ(bench.state(), "Ready");
    EXPECT_EQ(bench.result("SkewAtEnd"), 0.0) << "the pause is no skew";
    EXPECT_EQ(bench.result("LargestSkew"), 0.0);
    EXPECT_NEAR(bench.result("Duration"), 1.5, 1e-9);
}

TEST_F(SynchronizedStop, OneThatIsResumedAloneHaltsBoth) {
    suspendBoth();
    left().resumed();
    run();
    EXPECT_THAT(left().heard(), ElementsAre("halt"));
    EXPECT_THAT(right().heard(), ElementsAre("halt"));
    left().halted();
    right().halted();
    run();
    EXPECT_EQ(bench.state(), "Halted");
    EXPECT_EQ(bench.why(), "left was resumed alone");
}

TEST_F(SynchronizedStop, SuspendOfOneThatHasArrivedWaitsForTheOther) {
    bench.finish("left", 100.0, 103.0);
    ASSERT_TRUE(bench.call(bench.program->suspend(kClient)));
    EXPECT_THAT(left().heard(), IsEmpty());
    right().suspended();
    run();
    EXPECT_EQ(bench.state(), "Suspended");
    ASSERT_TRUE(bench.call(bench.program->resume(kClient)));
    given(right());
    EXPECT_THAT(left().heard(), IsEmpty());
    EXPECT_THAT(right().heard(), ElementsAre("suspend", "reset", "check"));
}

TEST_F(SynchronizedStop, HaltWhileSuspendedGivesBothUp) {
    suspendBoth();
    ASSERT_TRUE(bench.call(bench.program->halt(kClient)));
    EXPECT_THAT(left().heard(), ElementsAre("halt"));
    EXPECT_THAT(right().heard(), ElementsAre("halt"));
    EXPECT_EQ(bench.state(), "Halted");
    EXPECT_FALSE(left().runs()) << "nobody listens any more";
}

TEST(SynchronizedSuspend, WhileTheArmsAreAskedStopsThereAndGoesOnFromThere) {
    Bench bench;
    ASSERT_TRUE(bench.start());
    bench.answerCheck("left", 2.0, 0.0, 1.0);
    ASSERT_TRUE(bench.call(bench.program->suspend(kClient)));
    EXPECT_EQ(bench.state(), "Suspended");
    bench.answerCheck("right", 3.0, 0.0, -1.0);
    EXPECT_THAT(bench["left"].joint->heard(), Not(Contains("compareClocks")));
    ASSERT_TRUE(bench.call(bench.program->resume(kClient)));
    bench.answerAll();
    EXPECT_THAT(bench["right"].joint->heard(), Contains("begin"));
}

TEST(SynchronizedHalt, WhileTheArmsAreAskedIsAnsweredAtOnce) {
    Bench bench;
    ASSERT_TRUE(bench.start());
    ASSERT_TRUE(bench.call(bench.program->halt(kClient)));
    EXPECT_EQ(bench.state(), "Halted");
    EXPECT_THAT(bench["left"].joint->heard(), IsEmpty());
}

}  // namespace
}  // namespace metier::composition
