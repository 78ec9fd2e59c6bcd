// Suspend, Resume, Halt and Reset of a composed skill, in every state of its used skills.
#include <gmock/gmock.h>

#include "bench.hpp"

namespace metier::composition {
namespace {

using namespace std::chrono_literals;
using skill::Method;
using skill::Reason;
using skill::State;
using testing::Bench;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::kHead;
using testing::kOneThatIsReset;
using testing::kTwoSteps;

const std::string kBoth = kHead + R"(
[[step]]
name = "both"
[[step.parallel]]
name = "left"
run = "a"
[[step.parallel]]
name = "right"
run = "b"
)";

TEST(SuspendOfASequence, WaitsForItsStepToBeAtRest) {
    Bench bench(kTwoSteps);
    ASSERT_TRUE(bench.start());
    ASSERT_TRUE(bench.call(Method::suspend));
    EXPECT_THAT(bench["a"].heard(), ElementsAre("begin", "suspend"));
    EXPECT_EQ(bench.state(), "Running");
    EXPECT_EQ(bench.program->subState(), skill::SubState::stopping);
    bench["a"].suspended();
    bench.run();
    EXPECT_EQ(bench.state(), "Suspended");
    ASSERT_TRUE(bench.call(Method::resume));
    EXPECT_THAT(bench["a"].heard(), ElementsAre("resume"));
    EXPECT_EQ(bench.state(), "Running");
    bench["a"].resumed();
    bench["a"].finish();
    EXPECT_TRUE(bench["b"].runs());
}

TEST(SuspendOfASequence, WaitsForAllBranches) {
    Bench bench(kBoth);
    ASSERT_TRUE(bench.start());
    ASSERT_TRUE(bench.call(Method::suspend));
    bench["b"].suspended();
    bench.run();
    EXPECT_EQ(bench.state(), "Running");
    bench["a"].suspended();
    bench.run();
    EXPECT_EQ(bench.state(), "Suspended");
    ASSERT_TRUE(bench.call(Method::resume));
    EXPECT_THAT(bench["a"].heard(), ElementsAre("begin", "suspend", "resume"));
    EXPECT_THAT(bench["b"].heard(), ElementsAre("begin", "suspend", "resume"));
}

TEST(SuspendOfASequence, IsAtRestWhenItsStepFinishesAndBeginsTheNextOnResume) {
    Bench bench(kTwoSteps);
    bench["a"].suspend_answer = fail(Errc::not_supported, "cannot be suspended");
    ASSERT_TRUE(bench.start());
    ASSERT_TRUE(bench.call(Method::suspend));
    bench["a"].finish();
    bench.run();
    EXPECT_EQ(bench.state(), "Suspended");
    EXPECT_THAT(bench["b"].heard(), IsEmpty());
    ASSERT_TRUE(bench.call(Method::resume));
    EXPECT_THAT(bench["b"].heard(), ElementsAre("begin"));
}

TEST(SuspendOfASequence, IsReadyIfItsLastStepFinishesMeanwhile) {
    Bench bench(kBoth);
    ASSERT_TRUE(bench.start());
    bench["a"].finish();
    ASSERT_TRUE(bench.call(Method::suspend));
    bench["b"].finish();
    bench.run();
    EXPECT_EQ(bench.state(), "Ready");
}

TEST(SuspendOfASequence, HaltsAStepThatDoesNotComeToRest) {
    Bench bench(kTwoSteps);
    bench["a"].suspend_answer = fail(Errc::not_supported, "cannot be suspended");
    ASSERT_TRUE(bench.start());
    ASSERT_TRUE(bench.call(Method::suspend));
    bench.advance(1999ms);
    EXPECT_THAT(bench["a"].heard(), ElementsAre("begin", "suspend"));
    bench.advance(1ms);
    EXPECT_THAT(bench["a"].heard(), ElementsAre("halt"));
    bench["a"].halted();
    bench.run();
    EXPECT_EQ(bench.state(), "Halted");
    EXPECT_EQ(bench.why(),
              "not at rest within 2 s after Suspend, and halted: step first: MoveSkill a");
}

TEST(SuspendOfAUsedSkill, SuspendsAllOthersAtOnceAndThenTheWhole) {
    Bench bench(kBoth);
    ASSERT_TRUE(bench.start());
    bench["a"].stops(State::suspended, "by a panel");
    bench.run();
    EXPECT_THAT(bench["b"].heard(), ElementsAre("begin", "suspend")) << "before the first stands";
    EXPECT_THAT(bench["a"].heard(), ElementsAre("begin")) << "it brakes already";
    bench["a"].suspended();
    bench.run();
    EXPECT_EQ(bench.state(), "Running");
    bench["b"].suspended();
    bench.run();
    EXPECT_EQ(bench.state(), "Suspended");
    EXPECT_EQ(bench.program->reason(), Reason::by_client);
    EXPECT_EQ(bench.why(), "step both/left: MoveSkill a was suspended by a panel");
    ASSERT_TRUE(bench.call(Method::resume));
    EXPECT_THAT(bench["a"].heard(), ElementsAre("resume"));
    EXPECT_THAT(bench["b"].heard(), ElementsAre("resume"));
    bench["a"].resumed();
    bench["b"].resumed();
    bench.run();
    ASSERT_TRUE(bench.call(Method::suspend));
    EXPECT_THAT(bench["a"].heard(), ElementsAre("suspend")) << "as before";
}

TEST(SuspendOfAUsedSkill, SuspendsTheWholeAlsoIfItsServerSaysItOnlyAtStandstill) {
    Bench bench(kTwoSteps);
    ASSERT_TRUE(bench.start());
    bench["a"].suspended();
    bench.run();
    EXPECT_EQ(bench.state(), "Suspended");
    EXPECT_EQ(bench.why(), "step first: MoveSkill a was suspended");
    ASSERT_TRUE(bench.call(Method::resume));
    bench["a"].resumed();
    bench["a"].finish();
    bench.run();
    EXPECT_EQ(bench.state(), "Running");
    EXPECT_TRUE(bench["b"].runs());
}

TEST(SuspendOfAUsedSkill, ThatFinishesInsteadLetsNothingBeginUntilResume) {
    Bench bench(kTwoSteps);
    ASSERT_TRUE(bench.start());
    bench["a"].stops(State::suspended);
    bench.run();
    bench["a"].finish();
    bench.run();
    EXPECT_EQ(bench.state(), "Suspended");
    EXPECT_THAT(bench["b"].heard(), IsEmpty());
    ASSERT_TRUE(bench.call(Method::resume));
    EXPECT_THAT(bench["b"].heard(), ElementsAre("begin"));
}

TEST(SuspendOfASequence, SuspendsWhatAnotherClientResumes) {
    Bench bench(kTwoSteps);
    ASSERT_TRUE(bench.start());
    ASSERT_TRUE(bench.call(Method::suspend));
    bench["a"].suspended();
    bench.run();
    bench["a"].heard();
    bench["a"].resumed();
    EXPECT_THAT(bench["a"].heard(), ElementsAre("suspend"));
}

TEST(SuspendOfASequence, WaitsForAResetThatIsUnderWay) {
    Bench bench(kHead + R"(
reset = true
[[step]]
name = "first"
run = "b"
[[step]]
name = "second"
run = "a"
)");
    bench["b"].state_now = State::halted;
    ASSERT_TRUE(bench.start());
    ASSERT_TRUE(bench.call(Method::suspend));
    EXPECT_EQ(bench.state(), "Running");
    bench["b"].wasReset();
    bench.run();
    EXPECT_EQ(bench.state(), "Suspended");
    EXPECT_FALSE(bench["b"].runs()) << "nobody listens until it goes on";
    EXPECT_THAT(bench["b"].heard(), ElementsAre("reset"));
    ASSERT_TRUE(bench.call(Method::resume));
    EXPECT_THAT(bench["b"].heard(), ElementsAre("begin"));
}

TEST(SuspendOfASequence, IsThereDuringThePauseOfARetry) {
    Bench bench(kHead + R"(
[[step]]
name = "first"
run = "b"
retry = 1
pause = 5
[[step]]
name = "second"
run = "a"
)");
    ASSERT_TRUE(bench.start());
    bench["b"].refused("not yet");
    bench.advance(1s);
    ASSERT_TRUE(bench.call(Method::suspend));
    EXPECT_EQ(bench.state(), "Suspended");
    bench.advance(60s);
    EXPECT_THAT(bench["b"].heard(), ElementsAre("begin"));
    ASSERT_TRUE(bench.call(Method::resume));
    bench.advance(3999ms);
    EXPECT_THAT(bench["b"].heard(), IsEmpty());
    bench.advance(1ms);
    EXPECT_THAT(bench["b"].heard(), ElementsAre("begin"));
}

TEST(ResumeOfASequence, IsRefusedWithWhatItsStepSays) {
    Bench bench(kTwoSteps);
    ASSERT_TRUE(bench.start());
    ASSERT_TRUE(bench.call(Method::suspend));
    bench["a"].suspended();
    bench.run();
    bench["a"].resume_answer = fail(Errc::out_of_range, "moved by 0.2 m");
    const auto resumed = bench.call(Method::resume);
    ASSERT_FALSE(resumed);
    EXPECT_EQ(resumed.error().message, "moved by 0.2 m");
    EXPECT_EQ(bench.state(), "Suspended");
    bench["a"].resume_answer = {};
    EXPECT_TRUE(bench.call(Method::resume));
    EXPECT_EQ(bench.state(), "Running");
}

TEST(ResumeOfASequence, HaltsAllIfOneOfSeveralRefuses) {
    Bench bench(kBoth);
    ASSERT_TRUE(bench.start());
    ASSERT_TRUE(bench.call(Method::suspend));
    bench["a"].suspended();
    bench["b"].suspended();
    bench.run();
    bench["b"].resume_answer = fail(Errc::out_of_range, "moved by 0.2 m");
    ASSERT_TRUE(bench.call(Method::resume));
    EXPECT_THAT(bench["b"].heard(), ElementsAre("begin", "suspend", "resume", "halt"));
    bench["b"].halted();
    EXPECT_THAT(bench["a"].heard(), ElementsAre("begin", "suspend", "resume", "halt"));
    bench["a"].halted();
    bench.run();
    EXPECT_EQ(bench.state(), "Halted");
    EXPECT_EQ(bench.why(), "step both/right: MoveSkill b refused Resume: moved by 0.2 m");
}

TEST(ResumeOfASequence, HaltsAllIfAStepElsewhereRefusesLater) {
    Bench bench(kTwoSteps);
    ASSERT_TRUE(bench.start());
    ASSERT_TRUE(bench.call(Method::suspend));
    bench["a"].suspended();
    bench.run();
    ASSERT_TRUE(bench.call(Method::resume));
    bench["a"].listener->onRefused(Method::resume, {Errc::out_of_range, "moved by 0.2 m"});
    EXPECT_THAT(bench["a"].heard(), ElementsAre("begin", "suspend", "resume", "halt"));
    bench["a"].halted();
    bench.run();
    EXPECT_EQ(bench.state(), "Halted");
    EXPECT_THAT(bench.why(), HasSubstr("refused Resume: moved by 0.2 m"));
}

TEST(HaltOfASequence, WaitsForAllThatRuns) {
    Bench bench(kBoth);
    ASSERT_TRUE(bench.start());
    ASSERT_TRUE(bench.call(Method::halt));
    EXPECT_THAT(bench["a"].heard(), ElementsAre("begin", "halt"));
    EXPECT_THAT(bench["b"].heard(), ElementsAre("begin", "halt"));
    bench["a"].halted();
    bench.run();
    EXPECT_EQ(bench.state(), "Running");
    bench["b"].halted();
    bench.run();
    EXPECT_EQ(bench.state(), "Halted");
    EXPECT_EQ(bench.program->subState(), skill::SubState::halted_by_client);
}

TEST(HaltOfASequence, OvertakesASuspendThatIsUnderWay) {
    Bench bench(kTwoSteps);
    ASSERT_TRUE(bench.start());
    ASSERT_TRUE(bench.call(Method::suspend));
    ASSERT_TRUE(bench.call(Method::halt));
    EXPECT_THAT(bench["a"].heard(), ElementsAre("begin", "suspend", "halt"));
    bench["a"].suspended();
    bench.run();
    EXPECT_EQ(bench.state(), "Running") << "it is to be halted, not suspended";
    bench["a"].halted();
    bench.run();
    EXPECT_EQ(bench.state(), "Halted");
}

TEST(HaltOfASequence, BeginsNothingMoreIfAStepFinishesMeanwhile) {
    Bench bench(kTwoSteps);
    ASSERT_TRUE(bench.start());
    ASSERT_TRUE(bench.call(Method::halt));
    bench["a"].finish();
    bench.run();
    EXPECT_EQ(bench.state(), "Halted");
    EXPECT_THAT(bench["b"].heard(), IsEmpty());
}

TEST(HaltOfASequence, ReachesStepsThatAreSuspended) {
    Bench bench(kTwoSteps);
    ASSERT_TRUE(bench.start());
    ASSERT_TRUE(bench.call(Method::suspend));
    bench["a"].suspended();
    bench.run();
    ASSERT_TRUE(bench.call(Method::halt));
    EXPECT_EQ(bench.state(), "Halted");
    EXPECT_THAT(bench["a"].heard(), ElementsAre("begin", "suspend", "halt"));
    EXPECT_FALSE(bench["a"].runs()) << "nobody listens any more";
}

TEST(HaltOfASequence, EndsThePauseOfARetryAndALoop) {
    Bench bench(kHead + R"(
[[step]]
name = "loop"
times = 3
[[step.repeat]]
name = "first"
run = "b"
retry = 1
pause = 5
[[step.repeat]]
name = "second"
run = "a"
)");
    ASSERT_TRUE(bench.start());
    bench["b"].refused("not yet");
    bench.run();
    ASSERT_TRUE(bench.call(Method::halt));
    EXPECT_EQ(bench.state(), "Halted");
    EXPECT_EQ(bench.executor->timerCount(), 0U);
}

TEST(HaltOfASequence, WaitsForAResetThatIsUnderWayAndBeginsNothing) {
    Bench bench(kHead + R"(
reset = true
[[step]]
name = "first"
run = "b"
[[step]]
name = "second"
run = "a"
)");
    bench["b"].state_now = State::halted;
    ASSERT_TRUE(bench.start());
    ASSERT_TRUE(bench.call(Method::halt));
    EXPECT_EQ(bench.state(), "Running");
    bench["b"].wasReset();
    bench.run();
    EXPECT_EQ(bench.state(), "Halted");
    EXPECT_THAT(bench["b"].heard(), ElementsAre("reset"));
    EXPECT_FALSE(bench["b"].runs()) << "nobody listens any more";
}

TEST(HaltOfASequence, EndsAtOnceBetweenTwoAttemptsToReset) {
    Bench bench(kOneThatIsReset);
    bench["b"].state_now = State::halted;
    bench["b"].reset_answer = fail(Errc::timeout, "not yet");
    ASSERT_TRUE(bench.start());
    ASSERT_TRUE(bench.call(Method::halt));
    EXPECT_EQ(bench.state(), "Halted");
    bench.advance(1s);
    EXPECT_THAT(bench["b"].heard(), ElementsAre("reset"));
}

TEST(SuspendOfASequence, BetweenTwoAttemptsToResetAsksAgainOnceItGoesOn) {
    Bench bench(kOneThatIsReset);
    bench["b"].state_now = State::halted;
    bench["b"].reset_answer = fail(Errc::timeout, "not yet");
    ASSERT_TRUE(bench.start());
    ASSERT_TRUE(bench.call(Method::suspend));
    EXPECT_EQ(bench.state(), "Suspended");
    bench.advance(60s);
    EXPECT_THAT(bench["b"].heard(), ElementsAre("reset"));
    bench["b"].reset_answer = {};
    ASSERT_TRUE(bench.call(Method::resume));
    EXPECT_THAT(bench["b"].heard(), ElementsAre("reset"));
    bench["b"].wasReset();
    bench.advance(1s);
    EXPECT_THAT(bench["b"].heard(), ElementsAre("begin"));
}

TEST(HaltOfASequence, TellsOfAStepThatDoesNotEnd) {
    Bench bench(kTwoSteps);
    ASSERT_TRUE(bench.start());
    ASSERT_TRUE(bench.call(Method::halt));
    bench.advance(2s);
    EXPECT_EQ(bench.state(), "Halted");
    EXPECT_EQ(bench.why(), "step first: MoveSkill a did not end within 2 s after Halt");
    EXPECT_FALSE(bench["a"].runs());
}

TEST(OwnerLossOfASequence, ReachesWhatRuns) {
    Bench bench(kTwoSteps);
    ASSERT_TRUE(bench.start());
    bench.program->ownerLost("the client is gone");
    bench.run();
    EXPECT_THAT(bench["a"].heard(), ElementsAre("begin", "halt"));
    bench["a"].halted();
    bench.run();
    EXPECT_EQ(bench.program->subState(), skill::SubState::halted_owner_lost);
}

TEST(SuspendOfASequence, AsksNothingOfAStepThatIsSuspendedAlready) {
    Bench bench(kBoth);
    ASSERT_TRUE(bench.start());
    bench["a"].suspended();
    bench.run();
    EXPECT_THAT(bench["a"].heard(), ElementsAre("begin"));
    EXPECT_THAT(bench["b"].heard(), ElementsAre("begin", "suspend"));
}

TEST(SuspendOfASequence, IsNotTakenForAHaltThatAStepIsComingTo) {
    Bench bench(kBoth);
    ASSERT_TRUE(bench.start());
    bench["a"].stops(State::halted, "by a panel");
    bench.run();
    EXPECT_EQ(bench.program->subState(), skill::SubState::executing);
    EXPECT_THAT(bench["b"].heard(), ElementsAre("begin")) << "it is halted once the first stands";
}

TEST(SuspendOfASequence, KeepsTheTimeOfAStepThatWasRunningBefore) {
    Bench bench(kHead +
                "[[step]]\nname = \"first\"\nrun = \"a\"\ntimeout = 3\n"
                "[[step]]\nname = \"second\"\nrun = \"b\"\n");
    ASSERT_TRUE(bench.start());
    for (int i = 0; i < 2; ++i) {
        bench.advance(1s);
        ASSERT_TRUE(bench.call(Method::suspend));
        bench["a"].suspended();
        bench.advance(10s);
        ASSERT_TRUE(bench.call(Method::resume));
        bench["a"].resumed();
        bench.run();
    }
    bench["a"].heard();
    bench.advance(999ms);
    EXPECT_THAT(bench["a"].heard(), IsEmpty());
    bench.advance(1ms);
    EXPECT_THAT(bench["a"].heard(), ElementsAre("halt"));
}

TEST(HaltOfASequence, ReachesAStepOnceAlsoIfItIsToldTwice) {
    Bench bench(kBoth);
    ASSERT_TRUE(bench.start());
    bench["a"].halted(Reason::error, "stuck");
    bench.run();
    ASSERT_TRUE(bench.call(Method::halt));
    EXPECT_THAT(bench["b"].heard(), ElementsAre("begin", "halt"));
}

TEST(ResumeOfASequence, ThatIsRefusedTwiceHaltsOnce) {
    Bench bench(kTwoSteps);
    ASSERT_TRUE(bench.start());
    ASSERT_TRUE(bench.call(Method::suspend));
    bench["a"].suspended();
    bench.run();
    ASSERT_TRUE(bench.call(Method::resume));
    bench["a"].listener->onRefused(Method::resume, {Errc::out_of_range, "moved by 0.2 m"});
    bench["a"].listener->onRefused(Method::resume, {Errc::out_of_range, "moved by 0.3 m"});
    EXPECT_THAT(bench["a"].heard(), ElementsAre("begin", "suspend", "resume", "halt"));
    bench["a"].halted();
    bench.run();
    EXPECT_THAT(bench.why(), HasSubstr("moved by 0.2 m"));
}

}  // namespace
}  // namespace metier::composition
