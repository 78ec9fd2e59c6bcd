#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "program_bench.hpp"

namespace metier::skill::testing {
namespace {

using namespace std::chrono_literals;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

ProgramOptions quickRest() {
    return {.rest_deadline = 200ms};
}

TEST(ComingToRest, OfASuspendTurnsIntoAHaltIfThatFollows) {
    ProgramBench bench;
    bench.enter(State::running);
    ASSERT_TRUE(bench.program->suspend(kAlice));
    ASSERT_TRUE(bench.program->halt(kAlice));
    EXPECT_THAT(bench.script->calls, ElementsAre("suspend", "halt"));
    bench.script->execution.atRest();
    bench.run();
    EXPECT_THAT(bench.observer.transitions(), ElementsAre("RunningToHalted"));
}

TEST(ComingToRest, IsAnnouncedBeforeStandstillWithWhoAskedForIt) {
    ProgramBench bench;
    bench.enter(State::running);
    ASSERT_TRUE(bench.program->suspend(kBob));
    ASSERT_EQ(bench.observer.stops.size(), 1U) << "before the body has answered";
    EXPECT_EQ(bench.observer.stops[0].to, State::suspended);
    EXPECT_EQ(bench.observer.stops[0].reason, Reason::by_client);
    EXPECT_EQ(bench.observer.stops[0].reason_text, "by Bob's client");
    EXPECT_EQ(bench.observer.stops[0].execution_id, bench.program->executionId());
    ASSERT_TRUE(bench.program->halt(kAlice));
    ASSERT_EQ(bench.observer.stops.size(), 2U);
    EXPECT_EQ(bench.observer.stops[1].to, State::halted);
    EXPECT_EQ(bench.observer.stops[1].reason_text, "by Alice's client");
}

TEST(ComingToRest, OfABodyThatAsksForItIsASuspendWithItsReason) {
    ProgramBench bench;
    bench.enter(State::running);
    bench.script->execution.suspend("left was suspended by a panel");
    bench.script->execution.suspend("right was suspended, too");
    bench.run();
    EXPECT_THAT(bench.script->calls, ElementsAre("suspend"));
    EXPECT_EQ(bench.program->subState(), SubState::stopping);
    bench.script->execution.atRest();
    bench.run();
    EXPECT_EQ(bench.program->state(), State::suspended);
    EXPECT_EQ(bench.program->reason(), Reason::by_client);
    EXPECT_EQ(bench.program->reasonText(), "left was suspended by a panel");
    ASSERT_TRUE(bench.program->resume(kAlice));
    EXPECT_EQ(bench.program->state(), State::running);
}

TEST(ComingToRest, IsAHaltIfABodyAsksForASuspendThatItRefuses) {
    ProgramBench bench;
    bench.enter(State::running);
    bench.script->suspended = fail(Errc::not_supported, "not now");
    bench.script->execution.suspend("left was suspended");
    bench.run();
    bench.script->execution.atRest();
    bench.run();
    EXPECT_EQ(bench.program->state(), State::halted);
    EXPECT_EQ(bench.program->reasonText(), "left was suspended; not now");
}

TEST(ComingToRest, TakesAnAnswerToSuspendForTheHaltThatOvertookIt) {
    ProgramBench bench;
    bench.enter(State::running);
    ASSERT_TRUE(bench.program->suspend(kAlice));
    bench.script->execution.atRest();  // still on its way when Halt comes
    ASSERT_TRUE(bench.program->halt(kAlice));
    bench.run();
    EXPECT_THAT(bench.observer.transitions(), ElementsAre("RunningToHalted"));
}

TEST(ComingToRest, AcceptsASecondHaltWithoutAskingTheWorkAgain) {
    ProgramBench bench;
    bench.enter(State::running);
    ASSERT_TRUE(bench.program->halt(kAlice));
    EXPECT_TRUE(bench.program->halt(kBob));
    EXPECT_THAT(bench.script->calls, ElementsAre("halt"));
    bench.script->execution.atRest();
    bench.run();
    EXPECT_THAT(bench.observer.transitions(), ElementsAre("RunningToHalted"));
}

TEST(ComingToRest, MayBeAnsweredInsideTheRequest) {
    ProgramBench bench;
    bench.enter(State::running);
    bench.script->on_stop = [](const ExecutionHandle& execution) { execution.atRest(); };
    ASSERT_TRUE(bench.program->suspend(kAlice));
    EXPECT_EQ(bench.program->state(), State::running);
    bench.run();
    EXPECT_EQ(bench.program->state(), State::suspended);
    ASSERT_TRUE(bench.program->resume(kAlice));
    ASSERT_TRUE(bench.program->halt(kAlice));
    bench.run();
    EXPECT_EQ(bench.program->state(), State::halted);
}

TEST(ComingToRest, IsNotBelievedUnasked) {
    ProgramBench bench;
    bench.enter(State::running);
    bench.script->execution.atRest();
    bench.run();
    EXPECT_EQ(bench.program->state(), State::running);
    EXPECT_THAT(bench.observer.log, IsEmpty());
}

TEST(ComingToRest, IsNotBelievedFromASecondAnswerToAnEarlierSuspend) {
    ProgramBench bench;
    bench.enter(State::running);
    ASSERT_TRUE(bench.program->suspend(kAlice));
    bench.script->execution.atRest();
    bench.run();
    ASSERT_TRUE(bench.program->resume(kAlice));
    bench.script->execution.atRest();  // doubled, and late: it is still on its way
    ASSERT_TRUE(bench.program->halt(kAlice));
    bench.run();
    EXPECT_EQ(bench.program->subState(), SubState::stopping);
}

TEST(ComingToRest, OfASuspendMayEndInTheWorkBeingDone) {
    ProgramBench bench;
    bench.enter(State::running);
    ASSERT_TRUE(bench.program->suspend(kAlice));
    bench.script->execution.finish({{"Length", 0.4}});
    bench.run();
    EXPECT_THAT(bench.observer.transitions(), ElementsAre("RunningToReady"));
    EXPECT_EQ(bench.program->finalResult().at("Length"), Value(0.4));
    EXPECT_EQ(bench.executor->timerCount(), 0U);
}

TEST(ComingToRest, OfAHaltEndsHaltedAlsoIfTheWorkIsDoneMeanwhile) {
    ProgramBench bench;
    bench.enter(State::running);
    ASSERT_TRUE(bench.program->halt(kAlice));
    bench.script->execution.finish({{"Length", 0.4}});
    bench.run();
    EXPECT_THAT(bench.observer.transitions(), ElementsAre("RunningToHalted"));
    EXPECT_EQ(bench.program->finalResult().at("Length"), Value{});
}

TEST(ComingToRest, OfAHaltTellsTheErrorThatComesMeanwhile) {
    ProgramBench bench;
    bench.enter(State::running);
    ASSERT_TRUE(bench.program->halt(kAlice));
    bench.script->execution.fail(Reason::force_exceeded, "40 N over 30 N");
    bench.run();
    EXPECT_EQ(bench.program->subState(), SubState::halted_force);
}

TEST(ComingToRest, KeepsWorkDoneRightAfterTheSuspensionForTheResume) {
    ProgramBench bench;
    bench.enter(State::running);
    ASSERT_TRUE(bench.program->suspend(kAlice));
    bench.script->execution.atRest();
    bench.script->execution.finish({{"Length", 0.4}});
    bench.run();
    EXPECT_EQ(bench.program->state(), State::suspended);
    ASSERT_TRUE(bench.program->resume(kAlice));
    EXPECT_THAT(bench.observer.transitions(),
                ElementsAre("RunningToSuspended", "SuspendedToRunning", "RunningToReady"));
    EXPECT_EQ(bench.program->finalResult().at("Length"), Value(0.4));
}

TEST(ComingToRest, PastItsDeadlineUsesTheDevicesOwnStop) {
    ProgramBench bench(quickRest());
    bench.enter(State::running);
    ASSERT_TRUE(bench.program->halt(kAlice));
    bench.executor->advance(199ms);
    EXPECT_EQ(bench.program->state(), State::running);
    bench.executor->advance(1ms);
    EXPECT_EQ(bench.program->subState(), SubState::halted_error);
    EXPECT_THAT(bench.program->reasonText(), HasSubstr("200 ms"));
    EXPECT_THAT(bench.script->calls, ElementsAre("halt", "forceStop", "destroyed"));
}

TEST(ComingToRest, OfASuspendPastItsDeadlineIsHalted) {
    ProgramBench bench(quickRest());
    bench.enter(State::running);
    ASSERT_TRUE(bench.program->suspend(kAlice));
    bench.executor->advance(200ms);
    EXPECT_THAT(bench.observer.transitions(), ElementsAre("RunningToHalted"));
    EXPECT_THAT(bench.script->calls, ElementsAre("suspend", "forceStop", "destroyed"));
}

TEST(ComingToRest, PastItsDeadlineStillTellsThatTheOwnerWasLost) {
    ProgramBench bench(quickRest());
    bench.enter(State::running);
    bench.program->ownerLost("lease ran out");
    bench.executor->advance(200ms);
    EXPECT_EQ(bench.program->subState(), SubState::halted_owner_lost);
    EXPECT_THAT(bench.program->reasonText(), HasSubstr("lease ran out"));
}

TEST(ComingToRest, PastItsDeadlineNamesTheLostOwnerAlsoIfItWasToBeSuspended) {
    ProgramBench bench(quickRest());
    bench.enter(State::running);
    bench.program->ownerLost("lease of alice ran out", OwnerLossAction::suspend);
    bench.executor->advance(200ms);
    EXPECT_EQ(bench.program->subState(), SubState::halted_owner_lost);
    EXPECT_THAT(bench.program->reasonText(), HasSubstr("lease of alice ran out"));
}

TEST(ComingToRest, AnErrorWhileItIsSuspendedNamesTheLostOwner) {
    ProgramBench bench(quickRest());
    bench.enter(State::running);
    bench.program->ownerLost("lease of alice ran out", OwnerLossAction::suspend);
    bench.script->execution.fail(Reason::error, "off its set-point");
    bench.run();
    EXPECT_EQ(bench.program->reasonText(), "off its set-point (lease of alice ran out)");
}

TEST(ComingToRest, HasNoDeadlineLeftOnceAtRest) {
    ProgramBench bench(quickRest());
    bench.enter(State::suspended);
    EXPECT_EQ(bench.executor->timerCount(), 0U);
    bench.executor->advance(1h);
    EXPECT_EQ(bench.program->state(), State::suspended);
}

TEST(ComingToRest, HasANewDeadlineForTheHaltThatFollowsASuspend) {
    ProgramBench bench(quickRest());
    bench.enter(State::running);
    ASSERT_TRUE(bench.program->suspend(kAlice));
    bench.executor->advance(150ms);
    ASSERT_TRUE(bench.program->halt(kAlice));
    bench.executor->advance(199ms);
    EXPECT_EQ(bench.program->state(), State::running);
    bench.executor->advance(1ms);
    EXPECT_EQ(bench.program->state(), State::halted);
}

TEST(Suspend, IsRefusedWithTheBodysReasonAndNothingStops) {
    ProgramBench bench;
    bench.enter(State::running);
    bench.script->suspended = metier::fail(Errc::not_supported, "not while the arc burns");
    const auto refused = bench.program->suspend(kAlice);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().message, "not while the arc burns");
    EXPECT_EQ(bench.program->subState(), SubState::executing);
    EXPECT_EQ(bench.executor->timerCount(), 0U);
}

TEST(Suspend, IsNotExecutableForASkillThatCannot) {
    auto description = weldDescription();
    description.suspendable = false;
    ProgramBench bench({}, description);
    bench.enter(State::running);
    EXPECT_FALSE(bench.program->executable(Method::suspend, kAlice));
    const auto refused = bench.program->suspend(kAlice);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, Errc::not_supported);
    EXPECT_THAT(bench.script->calls, IsEmpty());
}

TEST(ComingToRest, OfAHaltTellsTheErrorThatComesMeanwhileAlone) {
    ProgramBench bench;
    bench.enter(State::running);
    ASSERT_TRUE(bench.program->halt(kAlice));
    bench.script->execution.fail(Reason::force_exceeded, "40 N over 30 N");
    bench.run();
    EXPECT_EQ(bench.program->reasonText(), "40 N over 30 N");
}

TEST(ComingToRest, OfAHaltThatOvertakesASuspendHasTheReasonOfTheHalt) {
    ProgramBench bench;
    bench.enter(State::running);
    bench.script->execution.suspend("left was suspended");
    bench.run();
    bench.program->deviceStopped("nobody watched");
    bench.script->execution.fail(Reason::error, "off its set-point");
    bench.run();
    EXPECT_EQ(bench.program->reasonText(), "off its set-point (nobody watched)");
}

}  // namespace
}  // namespace metier::skill::testing
