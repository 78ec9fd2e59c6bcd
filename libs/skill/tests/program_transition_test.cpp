#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>
#include <string>

#include "program_bench.hpp"

namespace metier::skill::testing {
namespace {

using namespace std::chrono_literals;
using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

TEST(Transition, OneGoesFromHaltedToReadyByReset) {
    ProgramBench bench;
    bench.enter(State::halted);
    ASSERT_TRUE(bench.program->reset(kAlice));
    EXPECT_THAT(bench.script->calls, ElementsAre("reset"));
    EXPECT_THAT(bench.observer.log,
                ElementsAre("sub-state ReadyNotConfigured", "diagnostic Reset", "HaltedToReady"));
    EXPECT_EQ(bench.observer.events[0].number, TransitionNumber{1});
}

TEST(Transition, OneWaitsUntilTheDeviceAgreesAndSaysWhyNot) {
    ProgramBench bench;
    bench.enter(State::halted);
    bench.script->reset = metier::fail(Errc::device_fault, "protective stop is still set");
    const auto refused = bench.program->reset(kAlice);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, Errc::device_fault);
    EXPECT_EQ(bench.program->state(), State::halted);
    EXPECT_EQ(bench.program->subState(), SubState::halted_by_client);
    EXPECT_EQ(bench.program->reasonText(), "protective stop is still set");
    EXPECT_THAT(bench.observer.log, ElementsAre("diagnostic Reset"));
    bench.script->reset = {};
    EXPECT_TRUE(bench.program->reset(kAlice));
    EXPECT_EQ(bench.program->state(), State::ready);
    EXPECT_EQ(bench.program->reasonText(), "");
}

TEST(Transition, TwoIsCommittedBeforeTheWorkStarts) {
    ProgramBench bench;
    bench.script->on_start = [&](const ExecutionHandle&) {
        bench.observer.log.emplace_back("body");
    };
    ASSERT_TRUE(bench.program->start(kAlice));
    EXPECT_THAT(bench.observer.log,
                ElementsAre("sub-state Executing", "diagnostic Start", "ReadyToRunning", "body"));
    EXPECT_EQ(bench.observer.events[0].number, TransitionNumber{2});
}

TEST(Transition, TwoComesBeforeFourAlsoIfTheWorkFinishesInsideItsStart) {
    ProgramBench bench;
    bench.script->on_start = [](const ExecutionHandle& execution) { execution.finish(); };
    ASSERT_TRUE(bench.program->start(kAlice));
    EXPECT_EQ(bench.program->state(), State::running);
    bench.run();
    EXPECT_THAT(bench.observer.transitions(), ElementsAre("ReadyToRunning", "RunningToReady"));
}

TEST(Transition, ThreeFollowsHaltAtStandstill) {
    ProgramBench bench;
    bench.enter(State::running);
    ASSERT_TRUE(bench.program->halt(kBob));
    EXPECT_EQ(bench.program->state(), State::running);
    EXPECT_EQ(bench.program->subState(), SubState::stopping);
    EXPECT_THAT(bench.observer.events, IsEmpty());
    bench.script->execution.atRest();
    bench.run();
    EXPECT_THAT(bench.observer.transitions(), ElementsAre("RunningToHalted"));
    EXPECT_EQ(bench.observer.events[0].number, TransitionNumber{3});
    EXPECT_EQ(bench.program->subState(), SubState::halted_by_client);
    EXPECT_THAT(bench.script->calls, ElementsAre("halt", "destroyed"));
}

TEST(Transition, ThreeFollowsAnErrorOfTheWorkWithItsReason) {
    const std::array<std::pair<Reason, SubState>, 5> cases{{
        {Reason::error, SubState::halted_error},
        {Reason::force_exceeded, SubState::halted_force},
        {Reason::limit_violated, SubState::halted_limit},
        {Reason::device_lost, SubState::halted_device_lost},
        {Reason::finished, SubState::halted_error},  // no reason for an error: taken as one
    }};
    for (const auto& [reason, sub_state] : cases) {
        ProgramBench bench;
        bench.enter(State::running);
        bench.script->execution.fail(reason, "axis 2: 3.2 rad/s over 3.14 rad/s");
        bench.run();
        ASSERT_EQ(bench.observer.events.size(), 1U) << toString(reason);
        const auto& event = bench.observer.events[0];
        EXPECT_EQ(event.number, TransitionNumber{3});
        EXPECT_EQ(haltedBecause(event.reason), sub_state) << toString(reason);
        EXPECT_EQ(event.reason_text, "axis 2: 3.2 rad/s over 3.14 rad/s");
        EXPECT_EQ(bench.program->subState(), sub_state);
    }
}

TEST(Transition, ThreeFollowsTheLossOfTheOwnerAtStandstill) {
    ProgramBench bench;
    bench.enter(State::running);
    bench.program->ownerLost("session timed out");
    EXPECT_EQ(bench.program->state(), State::running);
    bench.script->execution.atRest();
    bench.run();
    EXPECT_EQ(bench.program->subState(), SubState::halted_owner_lost);
    ASSERT_EQ(bench.observer.events.size(), 1U);
    EXPECT_EQ(bench.observer.events[0].reason, Reason::owner_lost);
    EXPECT_EQ(bench.observer.events[0].reason_text, "session timed out");
}

TEST(Transition, ThreeFollowsTheLossOfTheDeviceAtOnce) {
    ProgramBench bench;
    bench.enter(State::running);
    bench.program->deviceLost("no answer for 24 ms");
    EXPECT_EQ(bench.program->subState(), SubState::halted_device_lost);
    EXPECT_THAT(bench.observer.transitions(), ElementsAre("RunningToHalted"));
    EXPECT_THAT(bench.script->calls, ElementsAre("forceStop", "destroyed"));
}

TEST(Transition, FourComesAfterTheCompleteResult) {
    ProgramBench bench;
    bench.enter(State::running);
    std::vector<ValueMap> results;
    bench.observer.on_entry = [&](const std::string& /*entry*/) {
        results.push_back(bench.program->finalResult());
    };
    bench.script->execution.finish({{"Length", 0.4}, {"Good", true}, {"Undeclared", 1.0}});
    bench.run();
    EXPECT_THAT(bench.observer.log,
                ElementsAre("sub-state ReadyNotConfigured", "diagnostic Start", "RunningToReady"));
    EXPECT_THAT(results, Each(ValueMap{{"Length", 0.4}, {"Good", true}}));
    EXPECT_EQ(bench.observer.events[0].number, TransitionNumber{4});
    EXPECT_EQ(bench.observer.events[0].reason, Reason::finished);
}

TEST(Transition, FiveFollowsSuspendAtStandstill) {
    ProgramBench bench;
    bench.enter(State::running);
    ASSERT_TRUE(bench.program->suspend(kAlice));
    EXPECT_EQ(bench.program->state(), State::running);
    EXPECT_THAT(bench.observer.log, ElementsAre("sub-state Stopping", "diagnostic Suspend"));
    bench.script->execution.atRest();
    bench.run();
    EXPECT_THAT(bench.observer.transitions(), ElementsAre("RunningToSuspended"));
    EXPECT_EQ(bench.observer.events[0].number, TransitionNumber{5});
    EXPECT_EQ(bench.program->subState(), SubState::none);
    EXPECT_EQ(bench.script->bodies_alive, 1);
}

TEST(Transition, SixFollowsResumeOfTheSameWork) {
    ProgramBench bench;
    bench.enter(State::suspended);
    ASSERT_TRUE(bench.program->resume(kAlice));
    EXPECT_THAT(bench.observer.transitions(), ElementsAre("SuspendedToRunning"));
    EXPECT_EQ(bench.observer.events[0].number, TransitionNumber{6});
    EXPECT_EQ(bench.program->subState(), SubState::executing);
    EXPECT_THAT(bench.script->calls, ElementsAre("resume"));
}

TEST(Transition, SixIsRefusedWithTheDistanceIfTheArmWasMoved) {
    ProgramBench bench;
    bench.enter(State::suspended);
    bench.script->resumed = metier::fail(Errc::invalid_state, "moved by 0.031 m, limit 0.01 m");
    const auto refused = bench.program->resume(kAlice);
    ASSERT_FALSE(refused);
    EXPECT_THAT(refused.error().message, HasSubstr("0.031 m"));
    EXPECT_EQ(bench.program->state(), State::suspended);
    EXPECT_THAT(bench.observer.events, IsEmpty());
}

TEST(Transition, SevenFollowsHaltAtOnceAndTellsTheWork) {
    ProgramBench bench;
    bench.enter(State::suspended);
    ASSERT_TRUE(bench.program->halt(kAlice));
    EXPECT_THAT(bench.observer.transitions(), ElementsAre("SuspendedToHalted"));
    EXPECT_EQ(bench.observer.events[0].number, TransitionNumber{7});
    EXPECT_THAT(bench.script->calls, ElementsAre("halt", "destroyed"));
}

TEST(Transition, SevenFollowsAnError) {
    ProgramBench bench;
    bench.enter(State::suspended);
    bench.script->execution.fail(Reason::error, "the part fell");
    bench.run();
    EXPECT_THAT(bench.observer.transitions(), ElementsAre("SuspendedToHalted"));
    EXPECT_EQ(bench.program->subState(), SubState::halted_error);
}

TEST(Transition, EightFollowsResetAndTellsTheWork) {
    ProgramBench bench;
    bench.enter(State::suspended);
    ASSERT_TRUE(bench.program->reset(kAlice));
    EXPECT_THAT(bench.observer.transitions(), ElementsAre("SuspendedToReady"));
    EXPECT_EQ(bench.observer.events[0].number, TransitionNumber{8});
    EXPECT_THAT(bench.script->calls, ElementsAre("halt", "destroyed"));
    EXPECT_TRUE(bench.program->start(kAlice));
}

TEST(Transition, NineFollowsHalt) {
    ProgramBench bench;
    ASSERT_TRUE(bench.program->halt(kAlice));
    EXPECT_THAT(bench.observer.transitions(), ElementsAre("ReadyToHalted"));
    EXPECT_EQ(bench.observer.events[0].number, TransitionNumber{9});
    EXPECT_EQ(bench.program->subState(), SubState::halted_by_client);
}

TEST(Transition, NineFollowsTheLossOfTheDevice) {
    ProgramBench bench;
    bench.program->deviceLost("cable pulled");
    EXPECT_THAT(bench.observer.transitions(), ElementsAre("ReadyToHalted"));
    EXPECT_EQ(bench.program->subState(), SubState::halted_device_lost);
    EXPECT_EQ(bench.program->reasonText(), "cable pulled");
}

TEST(TransitionEvent, CarriesEveryField) {
    ProgramBench bench;
    bench.enter(State::running);
    const auto id = bench.script->execution.id();
    bench.script->execution.progress(0.25);
    bench.executor->advance(1500ms);
    const auto now = bench.executor->clock().utcNow();
    bench.script->execution.fail(Reason::force_exceeded, "31 N over 30 N");
    bench.run();
    ASSERT_EQ(bench.observer.events.size(), 1U);
    const auto& event = bench.observer.events[0];
    EXPECT_EQ(event.from, State::running);
    EXPECT_EQ(event.to, State::halted);
    EXPECT_EQ(event.time, now);
    EXPECT_EQ(event.execution_id, id);
    EXPECT_EQ(event.reason, Reason::force_exceeded);
    EXPECT_EQ(event.reason_text, "31 N over 30 N");
    EXPECT_EQ(event.intermediate_result, Value(0.25));
    EXPECT_EQ(event.message, "WeldSkill: Running to Halted: 31 N over 30 N");
    EXPECT_EQ(bench.program->lastTransition()->execution_id, id);
    EXPECT_EQ(bench.program->diagnostic().last_transition_time, now);
}

TEST(TransitionEvent, IsGraverForAFaultThanForAHaltThanForWorkDone) {
    const auto severity = [](auto act) {
        ProgramBench bench;
        bench.enter(State::running);
        act(bench);
        bench.run();
        return bench.observer.events.at(0).severity;
    };
    const auto fault = severity([](ProgramBench& bench) { bench.program->deviceLost("gone"); });
    const auto halt = severity([](ProgramBench& bench) {
        static_cast<void>(bench.program->halt(kAlice));
        bench.script->execution.atRest();
    });
    const auto done = severity([](ProgramBench& bench) { bench.script->execution.finish(); });
    EXPECT_GT(fault, halt);
    EXPECT_GT(halt, done);
    EXPECT_GE(done, 1);
    EXPECT_LE(fault, 1000);
}

TEST(TransitionEvent, CarriesNoExecutionWhereThereIsNone) {
    ProgramBench bench;
    bench.enter(State::running);
    bench.script->execution.progress(1.0);
    bench.script->execution.fail(Reason::error, "");
    bench.run();
    ASSERT_TRUE(bench.program->reset(kAlice));
    EXPECT_EQ(bench.observer.events.back().execution_id, "");
    EXPECT_EQ(bench.observer.events.back().intermediate_result, Value{});
}

TEST(ExecutionId, IsTheSameFromStartToEndAndNewForTheNextStart) {
    ProgramBench bench;
    bench.script->on_start = [](const ExecutionHandle& execution) { execution.finish(); };
    for (int i = 0; i < 2; ++i) {
        ASSERT_TRUE(bench.program->start(kAlice));
        bench.run();
    }
    const auto& events = bench.observer.events;
    ASSERT_EQ(events.size(), 4U);
    EXPECT_EQ(events[0].execution_id, events[1].execution_id);
    EXPECT_EQ(events[2].execution_id, events[3].execution_id);
    EXPECT_NE(events[0].execution_id, events[2].execution_id);
    EXPECT_THAT(events[0].execution_id, Not(IsEmpty()));
}

TEST(ExecutionId, IsUniqueAcrossRestartsOfTheServer) {
    std::set<std::string> ids;
    for (int i = 0; i < 200; ++i) {
        ProgramBench restarted;
        restarted.enter(State::running);
        ids.insert(restarted.script->execution.id());
    }
    EXPECT_EQ(ids.size(), 200U);
}

TEST(FinalResult, OfTheLastFinishedExecutionStays) {
    ProgramBench bench;
    EXPECT_EQ(bench.program->finalResult().at("Length"), Value{});
    bench.enter(State::running);
    bench.script->execution.finish({{"Length", 0.4}, {"Good", true}});
    bench.run();
    bench.enter(State::running);
    EXPECT_EQ(bench.program->finalResult().at("Length"), Value(0.4));
    bench.script->execution.fail(Reason::error, "arc lost");
    bench.run();
    EXPECT_EQ(bench.program->finalResult().at("Length"), Value(0.4));
    EXPECT_EQ(bench.program->finalResult().at("Good"), Value(true));
}

TEST(FinalResult, HoldsNoValueOfAnEarlierExecution) {
    ProgramBench bench;
    bench.enter(State::running);
    bench.script->execution.finish({{"Length", 0.4}, {"Good", true}});
    bench.run();
    bench.enter(State::running);
    bench.script->execution.finish({{"Length", 0.6}});
    bench.run();
    EXPECT_EQ(bench.program->finalResult(), (ValueMap{{"Good", Value{}}, {"Length", 0.6}}));
}

TEST(FinalResult, OfAnotherTypeThanDeclaredIsAnErrorAndIsNotTaken) {
    ProgramBench bench;
    bench.enter(State::running);
    bench.script->execution.finish({{"Length", std::string("long")}});
    bench.run();
    EXPECT_EQ(bench.program->subState(), SubState::halted_error);
    EXPECT_EQ(bench.program->reasonText(), "result Length: number expected, text given");
    EXPECT_EQ(bench.program->finalResult().at("Length"), Value{});
}

TEST(SubState, ChangesAreNoTransitions) {
    ProgramBench bench;
    ASSERT_TRUE(bench.program->write(kAlice, "Speed", 1.0));
    EXPECT_EQ(bench.program->subState(), SubState::ready_configured);
    bench.enter(State::running);
    bench.script->execution.step("approach");
    bench.script->execution.step("weld");
    bench.run();
    EXPECT_THAT(bench.observer.log,
                ElementsAre("sub-state Executing at approach", "sub-state Executing at weld"));
    EXPECT_EQ(bench.program->step(), "weld");
}

TEST(SubState, KeepsTheStepOverStoppingAndSuspension) {
    ProgramBench bench;
    bench.enter(State::running);
    bench.script->execution.step("weld");
    bench.run();
    ASSERT_TRUE(bench.program->suspend(kAlice));
    bench.script->execution.atRest();
    bench.run();
    ASSERT_TRUE(bench.program->resume(kAlice));
    EXPECT_THAT(bench.observer.log,
                ElementsAre("sub-state Executing at weld", "sub-state Stopping at weld",
                            "diagnostic Suspend", "sub-state None", "diagnostic Suspend",
                            "RunningToSuspended", "sub-state Executing at weld",
                            "diagnostic Resume", "SuspendedToRunning"));
    bench.script->execution.finish();
    bench.run();
    EXPECT_EQ(bench.program->step(), "");
}

}  // namespace
}  // namespace metier::skill::testing
