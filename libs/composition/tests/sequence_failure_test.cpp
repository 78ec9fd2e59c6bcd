// Every failure of a used skill ends the composed one with a text that names it, and leaves nothing
// running.
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
using testing::kHeadWithGrip;
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

TEST(FailureOfAStep, EndsTheSkillWithStepSkillAndReason) {
    struct Case {
        Reason reason;
        skill::SubState sub_state;
    };
    for (const auto& [reason, sub_state] :
         {Case{Reason::error, skill::SubState::halted_error},
          Case{Reason::by_client, skill::SubState::halted_error},
          Case{Reason::force_exceeded, skill::SubState::halted_force},
          Case{Reason::device_lost, skill::SubState::halted_device_lost},
          Case{Reason::limit_violated, skill::SubState::halted_limit}}) {
        Bench bench(kBoth);
        ASSERT_TRUE(bench.start());
        bench["a"].halted(reason, "7 rad/s over limit 3 rad/s");
        bench.run();
        EXPECT_EQ(bench.state(), "Running") << "the other branch has not ended";
        EXPECT_THAT(bench["b"].heard(), ElementsAre("begin", "halt"));
        bench["b"].halted();
        bench.run();
        EXPECT_EQ(bench.program->subState(), sub_state) << toString(reason);
        EXPECT_EQ(bench.why(), "step both/left: MoveSkill a was Halted (" +
                                   std::string(toString(reason)) + "): 7 rad/s over limit 3 rad/s");
    }
}

TEST(FailureOfAStep, TellsARefusedStartInTheWordsOfTheSkill) {
    Bench bench(kBoth);
    ASSERT_TRUE(bench.start());
    bench["a"].refused("Target: 7 m is over the limit 1 m");
    bench["b"].halted();
    bench.run();
    EXPECT_EQ(bench.why(),
              "step both/left: MoveSkill a refused Start: Target: 7 m is over the limit 1 m");
}

TEST(FailureOfAStep, IsALostDeviceIfTheSkillIsLost) {
    Bench bench(kBoth);
    ASSERT_TRUE(bench.start());
    bench["a"].listener->onEnd(
        {UsedSkillEnd::Kind::lost, {}, Reason::device_lost, "no connection"});
    bench["b"].halted();
    bench.run();
    EXPECT_EQ(bench.program->subState(), skill::SubState::halted_device_lost);
    EXPECT_EQ(bench.why(), "step both/left: MoveSkill a is lost: no connection");
}

TEST(FailureOfAStep, LeavesTheSkillRunningUntilTheOthersHaveEndedOrTheirTimeIsOver) {
    Bench bench(kBoth);
    ASSERT_TRUE(bench.start());
    bench["a"].halted(Reason::error, "stuck");
    bench.advance(1999ms);
    EXPECT_EQ(bench.state(), "Running");
    bench.advance(1ms);
    EXPECT_EQ(bench.state(), "Halted");
    EXPECT_EQ(bench.why(), "step both/right: MoveSkill b did not end within 2 s after Halt");
}

TEST(FailureOfAStep, HaltsAlsoWhatIsSuspended) {
    Bench bench(kBoth);
    ASSERT_TRUE(bench.start());
    ASSERT_TRUE(bench.call(Method::suspend));
    bench["a"].suspended();
    bench["b"].suspended();
    bench.run();
    ASSERT_EQ(bench.state(), "Suspended");
    bench["a"].halted(Reason::device_lost, "the cable is cut");
    EXPECT_THAT(bench["b"].heard(), ElementsAre("begin", "suspend", "halt"));
    bench["b"].halted();
    bench.run();
    EXPECT_EQ(bench.program->subState(), skill::SubState::halted_device_lost);
}

TEST(FailureOfAStep, InTheMiddleOfASuspendEndsTheSkill) {
    Bench bench(kBoth);
    ASSERT_TRUE(bench.start());
    ASSERT_TRUE(bench.call(Method::suspend));
    bench["a"].suspended();
    bench["b"].halted(Reason::error, "stuck");
    bench["a"].halted();
    bench.run();
    EXPECT_EQ(bench.state(), "Halted");
    EXPECT_THAT(bench.why(), HasSubstr("both/right: MoveSkill b was Halted (Error): stuck"));
}

TEST(FailureOfAStep, WhileItIsHaltedStaysHaltedByTheClient) {
    Bench bench(kBoth);
    ASSERT_TRUE(bench.start());
    ASSERT_TRUE(bench.call(Method::halt));
    bench["a"].halted(Reason::error, "did not brake well");
    bench["b"].halted();
    bench.run();
    EXPECT_EQ(bench.program->subState(), skill::SubState::halted_by_client);
}

TEST(FailureOfAStep, WhileItIsHaltedIsNotTriedAgain) {
    // The arm once moved again after Halt: the step that was lost meanwhile had a retry.
    Bench bench(kHead +
                "[[step]]\nname = \"first\"\nrun = \"a\"\nretry = 3\n"
                "[[step]]\nname = \"second\"\nrun = \"b\"\n");
    ASSERT_TRUE(bench.start());
    ASSERT_TRUE(bench.call(Method::halt));
    bench["a"].listener->onEnd(
        {UsedSkillEnd::Kind::lost, {}, Reason::device_lost, "no connection"});
    bench.advance(0ms);
    EXPECT_THAT(bench["a"].heard(), ElementsAre("begin", "halt"));
    EXPECT_EQ(bench.program->subState(), skill::SubState::halted_by_client);
}

TEST(FailureOfAStep, OfWhichAnotherHasFailedAtTheSameMomentIsNotTriedAgain) {
    Bench bench(kHead + R"(
[[step]]
name = "both"
[[step.parallel]]
name = "left"
fail = "left is wrong"
[[step.parallel]]
name = "right"
retry = 3
pause = 5
[[step.parallel.sequence]]
name = "wrong"
fail = "right is wrong"
[[step]]
name = "first"
run = "a"
[[step]]
name = "second"
run = "b"
)");
    ASSERT_TRUE(bench.start());
    EXPECT_EQ(bench.state(), "Halted");
    EXPECT_EQ(bench.why(), "step both/left: left is wrong");
}

TEST(FailureOfAStep, IsAResetOfASkillThatWasSuspended) {
    Bench bench(kHead +
                "[[step]]\nname = \"first\"\nrun = \"a\"\n"
                "[[step]]\nname = \"second\"\nrun = \"b\"\n");
    ASSERT_TRUE(bench.start());
    bench["a"].suspended();
    bench["a"].halted(Reason::by_client, "it was reset while it was suspended");
    bench.run();
    EXPECT_EQ(bench.state(), "Halted");
    EXPECT_THAT(bench["b"].heard(), IsEmpty());
}

TEST(FailureOfAStep, IsAResetThatIsRefused) {
    Bench bench(kHead +
                "reset = true\n[[step]]\nname = \"first\"\nrun = \"a\"\n"
                "[[step]]\nname = \"second\"\nrun = \"b\"\n");
    bench["b"].state_now = State::halted;
    ASSERT_TRUE(bench.start());
    bench["a"].finish();
    bench["b"].wasReset(fail(Errc::device_fault, "the emergency stop is pressed"));
    bench.run();
    EXPECT_EQ(bench.why(), "step second: MoveSkill b refused Reset: the emergency stop is pressed");
    EXPECT_FALSE(bench["b"].runs()) << "nobody listens any more";
}

TEST(FailureOfAStep, IsAResetThatNobodyAnswers) {
    Bench bench(kOneThatIsReset);
    bench["b"].state_now = State::halted;
    ASSERT_TRUE(bench.start());
    bench.advance(29'999ms);
    EXPECT_EQ(bench.state(), "Running");
    bench.advance(1ms);
    EXPECT_EQ(bench.state(), "Halted");
    EXPECT_EQ(bench.why(), "step first: MoveSkill b was not Ready within 30 s after Reset");
    EXPECT_FALSE(bench["b"].runs()) << "a late answer reaches nobody";
    EXPECT_EQ(bench.executor->timerCount(), 0U);
}

TEST(FailureOfAStep, IsAResetThatTheDeviceDoesNotEnd) {
    Bench bench(kOneThatIsReset);
    bench["b"].state_now = State::halted;
    bench["b"].reset_answer = fail(Errc::timeout, "the brakes are not released yet");
    ASSERT_TRUE(bench.start());
    bench.advance(30s);
    EXPECT_EQ(bench.state(), "Halted");
    EXPECT_EQ(bench.why(),
              "step first: MoveSkill b was not Ready within 30 s after Reset (the brakes are not "
              "released yet)");
}

TEST(FailureOfAStep, IsNotAResetThatTheDeviceTakesItsTimeFor) {
    Bench bench(kOneThatIsReset);
    bench["b"].state_now = State::halted;
    ASSERT_TRUE(bench.start());
    bench["b"].wasReset(fail(Errc::timeout, "the brakes are not released yet"));
    EXPECT_FALSE(bench["b"].runs()) << "nobody listens during the pause";
    bench.advance(99ms);
    EXPECT_THAT(bench["b"].heard(), ElementsAre("reset"));
    bench.advance(1ms);
    EXPECT_THAT(bench["b"].heard(), ElementsAre("reset"));
    bench["b"].wasReset();
    bench.run();
    EXPECT_THAT(bench["b"].heard(), ElementsAre("begin"));
    bench.advance(30s);
    bench["b"].finish();
    bench.run();
    EXPECT_EQ(bench.state(), "Ready");
}

TEST(FailureOfAStep, IsASkillThatSomebodyHaltedBeforeItsTurn) {
    Bench bench(kHead +
                "[[step]]\nname = \"first\"\nrun = \"a\"\n"
                "[[step]]\nname = \"second\"\nrun = \"b\"\n");
    ASSERT_TRUE(bench.start());
    bench["b"].state_now = State::halted;
    bench["b"].reason_text = "by a client";
    bench["a"].finish();
    bench.run();
    EXPECT_EQ(bench.state(), "Halted");
    EXPECT_THAT(bench.why(), HasSubstr("step second: MoveSkill b is Halted: by a client"));
}

TEST(FailureOfAStep, IsAValueThatIsNotThere) {
    Bench bench(kHeadWithGrip + R"(
[results.Width]
type = "number"
unit = "m"
from = "grasp.Width"
[[step]]
name = "grasp"
run = "grip"
with.Force = 1
[[step]]
name = "move"
run = "a"
[[step]]
name = "again"
run = "b"
with.Target = { from = "grasp.Width" }
)");
    ASSERT_TRUE(bench.start());
    bench["grip"].finish({{"Width", skill::Value{}}});
    bench["a"].finish();
    bench.run();
    EXPECT_EQ(bench.state(), "Halted");
    EXPECT_THAT(bench.why(), HasSubstr("step[2].with.Target (line 26): grasp.Width has no value"));
}

TEST(FailureOfAStep, IsOverForAllWithinTheDeadlineOfTheProgram) {
    // Suspend takes its time, then Halt of the step, too: the Program waits for both.
    Bench bench(kHead +
                "[[step]]\nname = \"first\"\nrun = \"a\"\n"
                "[[step]]\nname = \"second\"\nrun = \"b\"\n");
    ASSERT_TRUE(bench.start());
    ASSERT_TRUE(bench.call(Method::suspend));
    bench.advance(4s);
    EXPECT_EQ(bench.state(), "Halted");
    EXPECT_THAT(bench.why(), HasSubstr("not at rest within 2 s after Suspend"));
}

TEST(DestroyedWhileItRuns, AComposedSkillHaltsWhatRuns) {
    auto bench = std::make_unique<Bench>(kBoth);
    ASSERT_TRUE(bench->start());
    bench->program->deviceLost("the component ends");
    EXPECT_THAT((*bench)["a"].heard(), ElementsAre("begin", "halt"));
    EXPECT_FALSE((*bench)["a"].runs());
}

TEST(FailureOfAStep, IsASkillThatCannotBeReachedWhenItsTurnComes) {
    Bench bench(kTwoSteps);
    ASSERT_TRUE(bench.start());
    bench["b"].reachable = fail(Errc::connection_lost, "nobody is there");
    bench["a"].finish();
    bench.run();
    EXPECT_EQ(bench.program->subState(), skill::SubState::halted_device_lost);
    EXPECT_EQ(bench.why(), "step second: MoveSkill b cannot be reached: nobody is there");
    EXPECT_THAT(bench["b"].heard(), IsEmpty());
}

TEST(FailureOfAStep, ThatIsLostMayBeResetByTheNextStart) {
    Bench bench(kTwoSteps);
    ASSERT_TRUE(bench.start());
    bench["a"].listener->onEnd(
        {UsedSkillEnd::Kind::lost, {}, Reason::device_lost, "no connection"});
    bench.run();
    ASSERT_EQ(bench.state(), "Halted");
    bench["a"].state_now = State::halted;
    ASSERT_TRUE(bench.call(Method::reset));
    EXPECT_THAT(bench["a"].heard(), ElementsAre("begin", "reset"));
}

TEST(FailureOfAStep, ThatLostItsOwnerIsNotTriedAgain) {
    Bench bench(kHead +
                "reset = true\n[[step]]\nname = \"first\"\nrun = \"b\"\nretry = 3\n"
                "[[step]]\nname = \"second\"\nrun = \"a\"\n");
    ASSERT_TRUE(bench.start());
    bench["b"].halted(Reason::owner_lost, "no heartbeat");
    bench.advance(0ms);
    EXPECT_EQ(bench.state(), "Halted");
    EXPECT_THAT(bench["b"].heard(), ElementsAre("begin"));
}

TEST(FailureOfAStep, ThatDoesNotEndAfterHaltTellsWhatWasRefused) {
    Bench bench(kTwoSteps);
    ASSERT_TRUE(bench.start());
    ASSERT_TRUE(bench.call(Method::halt));
    bench["a"].listener->onRefused(Method::halt, {Errc::locked, "the lease is another's"});
    bench.advance(2s);
    EXPECT_EQ(bench.why(),
              "step first: MoveSkill a did not end within 2 s after Halt (Halt was refused: the "
              "lease is another's)");
}

TEST(FailureOfAStep, IsAResetThatIsNotAnsweredOnceTheSkillIsHalted) {
    Bench bench(kOneThatIsReset);
    bench["b"].state_now = State::halted;
    ASSERT_TRUE(bench.start());
    ASSERT_TRUE(bench.call(Method::halt));
    bench.advance(2s);
    EXPECT_EQ(bench.state(), "Halted");
    EXPECT_EQ(bench.why(), "step first: MoveSkill b did not end within 2 s after Halt");
    EXPECT_THAT(bench["b"].heard(), ElementsAre("reset"));
    EXPECT_FALSE(bench["b"].runs());
    EXPECT_EQ(bench.executor->timerCount(), 0U);
}

TEST(DestroyedWhileItRuns, AComposedSkillHaltsOnlyWhatItHasNotHaltedYetAndResetsIt) {
    Bench bench(kBoth);
    ASSERT_TRUE(bench.start());
    bench["a"].finish();
    ASSERT_TRUE(bench.call(Method::halt));
    bench.program->deviceLost("the component ends");
    EXPECT_THAT(bench["b"].heard(), ElementsAre("begin", "halt"));
    EXPECT_THAT(bench["a"].heard(), ElementsAre("begin"));
    bench["b"].state_now = State::halted;
    ASSERT_TRUE(bench.call(Method::reset));
    EXPECT_THAT(bench["b"].heard(), ElementsAre("reset"));
}

TEST(DestroyedWhileItRuns, AComposedSkillMayResetWhatItStopped) {
    Bench bench(kBoth);
    ASSERT_TRUE(bench.start());
    bench.program->deviceLost("the component ends");
    bench["a"].state_now = bench["b"].state_now = State::halted;
    bench["a"].heard();
    ASSERT_TRUE(bench.call(Method::reset));
    EXPECT_THAT(bench["a"].heard(), ElementsAre("reset"));
}

}  // namespace
}  // namespace metier::composition
