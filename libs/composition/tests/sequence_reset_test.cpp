// Reset of a composed skill: which used skills it resets, and when the whole may start again.
#include <gmock/gmock.h>

#include "bench.hpp"

namespace metier::composition {
namespace {

using namespace std::chrono_literals;
using skill::Method;
using skill::State;
using testing::Bench;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::kHead;
using testing::kTwoSteps;

/// `b` is a background step, which the end of `a` has halted.
class HaltedBackground : public ::testing::Test {
protected:
    void SetUp() override {
        ASSERT_TRUE(bench.start());
        bench["a"].finish();
        bench.run();
        ASSERT_THAT(bench["b"].heard(), ElementsAre("begin", "halt"));
    }
    void ends() {
        bench["b"].halted();
        bench.run();
    }

    Bench bench{kHead + R"(
[[step]]
name = "carry"
[[step.parallel]]
name = "move"
run = "a"
[[step.parallel]]
name = "watch"
run = "b"
background = true
)"};
};

TEST_F(HaltedBackground, IsReadyForOthersOnceTheSkillHasFinished) {
    ends();
    EXPECT_THAT(bench["b"].heard(), ElementsAre("reset"));
    EXPECT_EQ(bench.state(), "Running");
    bench["b"].wasReset();
    bench.run();
    EXPECT_EQ(bench.state(), "Ready");
    EXPECT_EQ(bench.executor->timerCount(), 0U);
    EXPECT_FALSE(bench["b"].runs()) << "nobody hears of it any more";
}

TEST_F(HaltedBackground, ThatCannotBeResetDoesNotUndoWhatIsDone) {
    bench["b"].reset_answer = fail(Errc::locked, "somebody else has control");
    ends();
    EXPECT_EQ(bench.state(), "Ready");
}

TEST_F(HaltedBackground, ThatRefusesLaterDoesNotUndoWhatIsDone) {
    ends();
    bench["b"].wasReset(fail(Errc::device_fault, "the emergency stop is pressed"));
    bench.run();
    EXPECT_EQ(bench.state(), "Ready");
}

TEST_F(HaltedBackground, IsAskedAgainIfItsDeviceTakesItsTime) {
    ends();
    bench["b"].wasReset(fail(Errc::timeout, "not yet"));
    bench.advance(100ms);
    EXPECT_THAT(bench["b"].heard(), ElementsAre("reset", "reset"));
    bench["b"].wasReset();
    bench.run();
    EXPECT_EQ(bench.state(), "Ready");
}

TEST_F(HaltedBackground, IsAskedAgainWhileItsArmComesToRest) {
    ends();
    bench["b"].wasReset(fail(Errc::resource_unavailable, "the arm still moves"));
    bench.advance(100ms);
    EXPECT_THAT(bench["b"].heard(), ElementsAre("reset", "reset"));
    bench["b"].wasReset();
    bench.run();
    EXPECT_EQ(bench.state(), "Ready");
}

TEST(ResetOfAUsedSkill, IsAskedAgainForAWhileIfItsArmComesToRest) {
    Bench bench(testing::kOneThatIsReset);
    bench["b"].state_now = State::halted;
    bench["b"].reset_answer = fail(Errc::resource_unavailable, "the arm still moves");
    ASSERT_TRUE(bench.start());
    bench.advance(1'900ms);
    EXPECT_EQ(bench.state(), "Running");
    bench.advance(200ms);
    EXPECT_EQ(bench.state(), "Halted") << "another client moves it";
    EXPECT_THAT(bench.why(), HasSubstr("refused Reset: the arm still moves"));
}

TEST_F(HaltedBackground, ThatDoesNotAnswerIsNotWaitedForLong) {
    ends();
    bench.advance(2s);
    EXPECT_EQ(bench.state(), "Ready");
    EXPECT_FALSE(bench["b"].runs());
    ASSERT_TRUE(bench.program->startWith(testing::kClient, {"again", {}}));
    bench.run();
    bench["a"].finish();
    bench.run();
    EXPECT_EQ(bench["b"].heard().front(), "reset") << "the next execution asks again";
}

TEST_F(HaltedBackground, IsResetWhileTheSkillIsSuspended) {
    ends();
    ASSERT_TRUE(bench.call(Method::suspend));
    EXPECT_EQ(bench.state(), "Suspended");
    bench["b"].wasReset();
    bench.run();
    EXPECT_EQ(bench.state(), "Suspended");
    ASSERT_TRUE(bench.call(Method::resume));
    EXPECT_EQ(bench.state(), "Ready");
}

TEST_F(HaltedBackground, KeepsNoHaltFromBeingTaken) {
    ends();
    ASSERT_TRUE(bench.call(Method::halt));
    EXPECT_EQ(bench.state(), "Halted");
    EXPECT_FALSE(bench["b"].runs());
    EXPECT_EQ(bench.executor->timerCount(), 0U);
}

TEST_F(HaltedBackground, StaysHaltedIfTheSkillIsHalted) {
    ASSERT_TRUE(bench.call(Method::halt));
    ends();
    EXPECT_EQ(bench.state(), "Halted");
    EXPECT_THAT(bench["b"].heard(), IsEmpty());
    ASSERT_TRUE(bench.call(Method::reset));
    EXPECT_THAT(bench["b"].heard(), ElementsAre("reset"));
}

TEST(ResetOfASequence, ResetsWhatItHaltedItself) {
    Bench bench(kTwoSteps);
    ASSERT_TRUE(bench.start());
    ASSERT_TRUE(bench.call(Method::halt));
    bench["a"].halted();
    bench.run();
    bench["b"].state_now = State::halted;  // by another client
    bench["a"].heard();
    ASSERT_TRUE(bench.call(Method::reset));
    EXPECT_THAT(bench["a"].heard(), ElementsAre("reset"));
    EXPECT_THAT(bench["b"].heard(), IsEmpty());
    EXPECT_EQ(bench.state(), "Ready");
}

TEST(ResetOfASequence, GivesNoRightToAnotherReset) {
    // A skill halted by a client after it was reset by the next Start.
    Bench bench(kTwoSteps);
    ASSERT_TRUE(bench.start());
    ASSERT_TRUE(bench.call(Method::halt));
    bench["a"].halted();
    bench.run();
    ASSERT_TRUE(bench.call(Method::reset));
    bench["a"].wasReset();
    bench["a"].state_now = State::halted;  // by a client
    EXPECT_FALSE(bench.program->startWith(testing::kClient, {"again", {}}));
    EXPECT_THAT(bench["a"].heard(), ElementsAre("begin", "halt", "reset"));
}

TEST(ResetOfASequence, IsRefusedIfAUsedSkillRefusesAtOnce) {
    Bench bench(kTwoSteps);
    ASSERT_TRUE(bench.start());
    ASSERT_TRUE(bench.call(Method::halt));
    bench["a"].halted();
    bench.run();
    bench["a"].reset_answer = fail(Errc::device_fault, "the emergency stop is pressed");
    EXPECT_FALSE(bench.call(Method::reset));
    EXPECT_EQ(bench.state(), "Halted");
    EXPECT_EQ(bench.why(), "MoveSkill a (a) refused Reset: the emergency stop is pressed");
}

TEST(StartOfASequence, ResetsWhatMayBeReset) {
    Bench bench(kTwoSteps);
    ASSERT_TRUE(bench.start());
    ASSERT_TRUE(bench.call(Method::halt));
    bench["a"].halted();
    bench.run();
    ASSERT_TRUE(bench.call(Method::reset));  // its outcome is not there yet
    ASSERT_TRUE(bench.start());
    ASSERT_EQ(bench.program->startWith(testing::kClient, {"run", {}}), "run")
        << "an id that is known starts nothing";
    ASSERT_TRUE(bench.program->startWith(testing::kClient, {"again", {}}));
    EXPECT_THAT(bench["a"].heard(), ElementsAre("begin", "halt", "reset", "reset"));
    bench["a"].wasReset();
    EXPECT_THAT(bench["a"].heard(), ElementsAre("begin"));
}

TEST(StartOfASequence, IsRefusedIfAUsedSkillIsHaltedByOthers) {
    Bench bench(kTwoSteps);
    bench["b"].state_now = State::halted;
    bench["b"].reason_text = "protective stop";
    const auto started = bench.start();
    ASSERT_FALSE(started);
    EXPECT_EQ(started.error().code, Errc::invalid_state);
    EXPECT_THAT(started.error().message,
                HasSubstr("MoveSkill b (b) is Halted: protective stop; reset it"));
    EXPECT_THAT(bench["a"].heard(), IsEmpty());
}

TEST(StartOfASequence, IsRefusedIfAUsedSkillRunsOrCannotBeReached) {
    Bench bench(kTwoSteps);
    bench["b"].state_now = State::running;
    EXPECT_EQ(bench.start().error().message, "MoveSkill b (b) is Running");
    bench["b"].state_now = State::ready;
    bench["b"].reachable = fail(Errc::connection_lost, "nobody is there");
    const auto started = bench.program->startWith(testing::kClient, {"other", {}});
    ASSERT_FALSE(started);
    EXPECT_EQ(started.error().code, Errc::connection_lost);
}

TEST_F(HaltedBackground, ThatHasEndedByItselfIsNotReset) {
    bench["b"].finish();
    bench.run();
    EXPECT_EQ(bench.state(), "Ready");
    EXPECT_THAT(bench["b"].heard(), IsEmpty());
}

TEST_F(HaltedBackground, ThatCannotBeReachedIsNotAsked) {
    bench["b"].reachable = fail(Errc::connection_lost, "nobody is there");
    ends();
    EXPECT_EQ(bench.state(), "Ready");
    EXPECT_THAT(bench["b"].heard(), IsEmpty());
}

TEST_F(HaltedBackground, ThatRefusesTheSecondTimeIsLeftHalted) {
    ends();
    bench["b"].wasReset(fail(Errc::timeout, "not yet"));
    bench.advance(99ms);
    EXPECT_THAT(bench["b"].heard(), ElementsAre("reset"));
    bench["b"].reset_answer = fail(Errc::device_fault, "the emergency stop is pressed");
    bench.advance(1ms);
    EXPECT_THAT(bench["b"].heard(), ElementsAre("reset"));
    bench.run();
    EXPECT_EQ(bench.state(), "Ready");
    EXPECT_EQ(bench.executor->timerCount(), 0U);
}

TEST_F(HaltedBackground, ThatWasResetIsNotResetByTheNextStart) {
    ends();
    bench["b"].wasReset();
    bench.run();
    bench["b"].heard();
    bench["b"].state_now = State::halted;  // by a client
    const auto refused = bench.program->startWith(testing::kClient, {"again", {}});
    ASSERT_FALSE(refused);
    EXPECT_THAT(refused.error().message, HasSubstr("reset it, or write reset = true"));
}

TEST(ResetOfASequence, AsksNobodyWhoIsReadyOrCannotBeReached) {
    Bench bench(kHead + R"(
reset = true
[[step]]
name = "first"
run = "b"
[[step]]
name = "second"
run = "a"
)");
    ASSERT_TRUE(bench.call(Method::halt));
    ASSERT_TRUE(bench.call(Method::reset));
    EXPECT_THAT(bench["b"].heard(), IsEmpty()) << "it is Ready";
    ASSERT_TRUE(bench.call(Method::halt));
    bench["b"].state_now = State::halted;
    bench["b"].reachable = fail(Errc::connection_lost, "nobody is there");
    ASSERT_TRUE(bench.call(Method::reset));
    EXPECT_THAT(bench["b"].heard(), IsEmpty());
    ASSERT_TRUE(bench.call(Method::halt));
    bench["b"].reachable = {};
    ASSERT_TRUE(bench.call(Method::reset));
    EXPECT_THAT(bench["b"].heard(), ElementsAre("reset"));
}

TEST(ResetOfASequence, ThatFailsLaterMayBeAskedForAgain) {
    Bench bench(kTwoSteps);
    ASSERT_TRUE(bench.start());
    ASSERT_TRUE(bench.call(Method::halt));
    bench["a"].halted();
    bench.run();
    ASSERT_TRUE(bench.call(Method::reset));
    bench["a"].wasReset(fail(Errc::device_fault, "too hot"));
    bench["a"].heard();
    ASSERT_TRUE(bench.program->startWith(testing::kClient, {"again", {}}));
    bench.run();
    EXPECT_THAT(bench["a"].heard(), ElementsAre("reset"));
}

TEST(StartOfASequence, IsRefusedWhileAUsedSkillIsSuspended) {
    Bench bench(kTwoSteps);
    bench["b"].state_now = State::suspended;
    const auto refused = bench.start();
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, Errc::resource_unavailable);
    EXPECT_EQ(refused.error().message, "MoveSkill b (b) is Suspended");
}

TEST(StartOfASequence, AsksOnlyForTheSkillsThatEveryExecutionComesBy) {
    struct Case {
        const char* keys;
        const char* where;
        bool needed;
    };
    for (const auto& [keys, where, needed] :
         {Case{"", "sequence", true}, Case{"", "parallel", true},
          Case{"wait_for = \"any\"\n", "parallel", false}, Case{"", "fallback", false},
          Case{"times = 2\n", "repeat", true},
          Case{"at_most = 2\nwhile = { from = \"Ok\", is = true }\n", "repeat", false},
          Case{"if = { from = \"Ok\", is = true }\n", "then", false}}) {
        Bench bench(kHead + "[parameters.Ok]\ntype = \"boolean\"\ndefault = true\n" +
                    "[[step]]\nname = \"first\"\nrun = \"a\"\n[[step]]\nname = \"group\"\n" + keys +
                    "[[step." + where + "]]\nname = \"second\"\nrun = \"b\"\n");
        bench["b"].state_now = State::halted;
        EXPECT_EQ(bench.start().has_value(), !needed) << where << keys;
    }
}

}  // namespace
}  // namespace metier::composition
