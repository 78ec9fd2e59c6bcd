#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <string>

#include "program_bench.hpp"

namespace metier::skill::testing {
namespace {

using namespace std::chrono_literals;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

TEST(Observer, FindsTheRecordOfAnExecutionThatBegins) {
    ProgramBench bench;
    bench.executor->advance(3s);
    const auto now = bench.executor->clock().utcNow();
    ExecutionRecord begun;
    bench.observer.on_entry = [&](const std::string& entry) {
        if (entry == "ReadyToRunning") {
            begun = *bench.program->recentExecution(0);
        }
    };
    ASSERT_TRUE(bench.program->startWith(
        kAlice,
        {.execution_id = "seam 7", .parameters = {{"Speed", 1.0}}, .parent = {.id = "car 12"}}));
    EXPECT_EQ(begun.id, "seam 7");
    EXPECT_EQ(begun.client.client_name, "Alice's client");
    EXPECT_EQ(begun.parent.id, "car 12");
    EXPECT_EQ(begun.parameters->at("Speed"), Value(1.0));
    EXPECT_EQ(begun.start_time, now);
    EXPECT_EQ(begun.end_time, UtcTime{});
}

TEST(Observer, IsShownWhatAnExecutionHasStarted) {
    ProgramBench bench;
    bench.enter(State::running);
    bench.script->execution.started({"grip 3", "GraspGripperSkill", "opc.tcp://gripper:4840"});
    bench.run();
    ASSERT_THAT(bench.observer.children, SizeIs(1));
    EXPECT_EQ(bench.observer.children[0].id, "grip 3");
    EXPECT_EQ(bench.observer.children[0].skill, "GraspGripperSkill");
    EXPECT_EQ(bench.observer.children[0].server_url, "opc.tcp://gripper:4840");
}

TEST(Observer, IsShownWhoCheckedWhatWithWhichOutcome) {
    ProgramBench bench;
    static_cast<void>(bench.program->check(kAlice, {{"Speed", 1.0}}));
    static_cast<void>(bench.program->check(kBob, {{"Speed", 2.5}}));
    ASSERT_THAT(bench.observer.checks, SizeIs(2));
    EXPECT_EQ(bench.observer.checks[0].caller.session_id, "alice");
    EXPECT_EQ(bench.observer.checks[0].parameters.at("Speed"), Value(1.0));
    EXPECT_TRUE(bench.observer.checks[0].report.possible);
    EXPECT_EQ(bench.observer.checks[0].report.first_failing_fraction, 1.0);
    EXPECT_EQ(bench.observer.checks[1].caller.session_id, "bob");
    EXPECT_FALSE(bench.observer.checks[1].report.possible);
    EXPECT_EQ(bench.observer.checks[1].report.first_failing_fraction, 0.0);
}

TEST(Observer, MayNotCheckFromInsideANotification) {
    ProgramBench bench;
    CheckReport inside;
    bench.observer.on_entry = [&](const std::string& entry) {
        if (entry == "ReadyToHalted") {
            inside = bench.program->check(kAlice, {});
        }
    };
    ASSERT_TRUE(bench.program->halt(kAlice));
    EXPECT_FALSE(inside.possible);
    EXPECT_THAT(inside.reason, HasSubstr("inside a notification"));
    EXPECT_THAT(bench.observer.checks, IsEmpty());
}

TEST(Observer, IsShownIntermediateResultsOnceEach) {
    ProgramBench bench;
    bench.enter(State::running);
    bench.script->execution.progress(0.25);
    bench.script->execution.progress(0.5);
    bench.run();
    EXPECT_THAT(bench.observer.log, ElementsAre("progress 0.25", "progress 0.5"));
    EXPECT_EQ(bench.program->intermediate(), Value(0.5));
}

TEST(Observer, IsNotShownASubStateForAStepThatIsNamedWhileSuspended) {
    ProgramBench bench;
    bench.enter(State::suspended);
    bench.script->execution.step("weld");
    bench.run();
    EXPECT_THAT(bench.observer.log, IsEmpty());
    ASSERT_TRUE(bench.program->resume(kAlice));
    EXPECT_EQ(bench.observer.log.at(0), "sub-state Executing at weld");
}

TEST(ExecutionHandle, IsRecordedFromStartToEnd) {
    ProgramBench bench;
    ASSERT_TRUE(bench.program->startWith(kAlice, {.execution_id = "seam 7"}));
    EXPECT_EQ(bench.program->execution("seam 7")->state, State::running);
    EXPECT_EQ(bench.program->execution("seam 7")->end_time, UtcTime{});
    bench.executor->advance(2s);
    ASSERT_TRUE(bench.program->suspend(kAlice));
    bench.script->execution.atRest();
    bench.run();
    EXPECT_EQ(bench.program->execution("seam 7")->state, State::suspended);
    EXPECT_EQ(bench.program->execution("seam 7")->end_time, UtcTime{});
    bench.executor->advance(2s);
    const auto end = bench.executor->clock().utcNow();
    ASSERT_TRUE(bench.program->halt(kAlice));
    bench.executor->advance(2s);
    ASSERT_TRUE(bench.program->reset(kAlice));
    const auto record = bench.program->execution("seam 7");
    EXPECT_EQ(record->state, State::halted);
    EXPECT_EQ(record->reason, Reason::by_client);
    EXPECT_EQ(record->end_time, end);
    EXPECT_THAT(record->result, IsEmpty()) << "it did not finish";
}

TEST(ExecutionHandle, OfAnUnknownNameIsRefusedWithThatName) {
    const ProgramBench bench;
    const auto unknown = bench.program->execution("seam 8");
    ASSERT_FALSE(unknown);
    EXPECT_EQ(unknown.error().code, Errc::not_found);
    EXPECT_EQ(unknown.error().message, "WeldSkill: no execution \"seam 8\" is known");
}

TEST(TransitionEvent, NamesSkillAndStatesAlsoWithoutAText) {
    ProgramBench bench;
    ASSERT_TRUE(bench.program->start(kAlice));
    EXPECT_EQ(bench.observer.events.at(0).message, "WeldSkill: Ready to Running");
}

TEST(StoppingEvent, NamesTheReasonThatWasGivenAndElseTheClient) {
    ProgramBench bench;
    bench.enter(State::running);
    bench.executor->advance(1s);
    bench.script->execution.suspend("left was suspended by a panel");
    bench.run();
    ASSERT_THAT(bench.observer.stops, SizeIs(1));
    EXPECT_EQ(bench.observer.stops[0].reason_text, "left was suspended by a panel");
    EXPECT_EQ(bench.observer.stops[0].time, bench.executor->clock().utcNow());
    bench.program->ownerLost("");
    ASSERT_THAT(bench.observer.stops, SizeIs(2));
    EXPECT_EQ(bench.observer.stops[1].reason, Reason::owner_lost);
    EXPECT_EQ(bench.observer.stops[1].reason_text, "");
}

}  // namespace
}  // namespace metier::skill::testing
