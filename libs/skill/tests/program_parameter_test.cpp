#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "program_bench.hpp"

namespace metier::skill::testing {
namespace {

using namespace std::chrono_literals;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

TEST(ParameterWrite, IsCheckedAndLeavesTheOldValueIfBad) {
    ProgramBench bench;
    const auto too_fast = bench.program->write(kAlice, "Speed", 2.5);
    ASSERT_FALSE(too_fast);
    EXPECT_EQ(too_fast.error().code, Errc::out_of_range);
    EXPECT_EQ(too_fast.error().message, "Speed: 2.5 m/s is over the limit 2 m/s");
    EXPECT_EQ(bench.program->write(kAlice, "Speed", true).error().code, Errc::type_mismatch);
    EXPECT_EQ(bench.program->write(kAlice, "Sped", 1.0).error().code, Errc::not_found);
    EXPECT_EQ(bench.program->read("Speed"), Value(0.5));
    EXPECT_EQ(bench.program->subState(), SubState::ready_not_configured);
    EXPECT_THAT(bench.observer.log, IsEmpty());
}

TEST(ParameterWrite, ThatWasRefusedBindsNobody) {
    ProgramBench bench;
    EXPECT_FALSE(bench.program->write(kAlice, "Speed", 2.5));
    EXPECT_TRUE(bench.program->write(kBob, "Speed", 1.0));
}

TEST(ParameterWrite, OfNullMeansTheDefault) {
    ProgramBench bench;
    ASSERT_TRUE(bench.program->write(kAlice, "Speed", 1.0));
    EXPECT_EQ(bench.program->read("Speed"), Value(1.0));
    ASSERT_TRUE(bench.program->write(kAlice, "Speed", Value{}));
    EXPECT_EQ(bench.program->read("Speed"), Value(0.5));
    EXPECT_THAT(bench.observer.log, ElementsAre("sub-state ReadyConfigured"));
}

TEST(ParameterWrite, IsPossibleOnlyWhileReady) {
    for (const auto state : {State::halted, State::running, State::suspended}) {
        ProgramBench bench;
        bench.enter(state);
        const auto refused = bench.program->write(kAlice, "Speed", 1.0);
        ASSERT_FALSE(refused) << toString(state);
        EXPECT_EQ(refused.error().code, Errc::invalid_state);
        EXPECT_THAT(refused.error().message, HasSubstr(std::string(toString(state))));
        EXPECT_EQ(bench.program->read("Speed"), Value(0.5));
    }
}

TEST(ParameterRead, OfAnUnknownNameIsRefused) {
    const ProgramBench bench;
    EXPECT_EQ(bench.program->read("Sped").error().code, Errc::not_found);
}

/// The parameters of an execution that has just ended.
std::shared_ptr<const ValueMap> parametersOfOne(ProgramBench& bench) {
    EXPECT_TRUE(bench.program->start(kAlice));
    bench.script->execution.finish();
    bench.executor->run();
    return bench.program->recentExecution(0)->parameters;
}

TEST(ParameterSnapshot, IsSharedByExecutionsOfTheSameValues) {
    ProgramBench bench;
    const auto first = parametersOfOne(bench);
    EXPECT_EQ(parametersOfOne(bench), first);
    ASSERT_TRUE(bench.program->write(kAlice, "Speed", 1.0));
    const auto other = parametersOfOne(bench);
    EXPECT_EQ(other->at("Speed"), Value(1.0));
    EXPECT_EQ(first->at("Speed"), Value(0.5));
    EXPECT_EQ(parametersOfOne(bench)->at("Speed"), Value(0.5));
}

TEST(Binding, BeginsWithTheFirstWriteAndLocksOthersOut) {
    ProgramBench bench;
    ASSERT_TRUE(bench.program->write(kAlice, "Speed", 1.0));
    EXPECT_EQ(bench.program->subState(), SubState::ready_configured);
    EXPECT_EQ(bench.program->write(kBob, "Speed", 1.5).error().code, Errc::locked);
    EXPECT_EQ(bench.program->write(kBob, "Seam", Value{}).error().code, Errc::locked);
    EXPECT_EQ(bench.program->start(kBob).error().code, Errc::locked);
    EXPECT_FALSE(bench.program->executable(Method::start, kBob));
    EXPECT_TRUE(bench.program->executable(Method::start, kAlice));
    EXPECT_EQ(bench.program->read("Speed"), Value(1.0));
    EXPECT_EQ(bench.program->state(), State::ready);
}

TEST(Binding, IsNotNeededForAStartWithDefaults) {
    ProgramBench bench;
    ASSERT_TRUE(bench.program->start(kBob));
    EXPECT_EQ(bench.script->snapshot.at("Speed"), Value(0.5));
    EXPECT_EQ(bench.script->snapshot.at("Seam"), Value(std::string("straight")));
}

TEST(Binding, EndsWithStartAndTheValuesFallBack) {
    ProgramBench bench;
    ASSERT_TRUE(bench.program->write(kAlice, "Speed", 1.0));
    ASSERT_TRUE(bench.program->write(kAlice, "Seam", std::string("straight")));
    bench.forget();
    ASSERT_TRUE(bench.program->start(kAlice));
    EXPECT_EQ(bench.script->snapshot.at("Speed"), Value(1.0));
    EXPECT_EQ(bench.program->read("Speed"), Value(0.5));
    EXPECT_THAT(bench.observer.log,
                ElementsAre("sub-state Executing", "diagnostic Start", "ReadyToRunning"));
    bench.script->execution.finish();
    bench.run();
    EXPECT_EQ(bench.program->subState(), SubState::ready_not_configured);
    EXPECT_TRUE(bench.program->write(kBob, "Speed", 1.5));
}

TEST(Binding, EndsWithTheSession) {
    ProgramBench bench;
    ASSERT_TRUE(bench.program->write(kAlice, "Speed", 1.0));
    bench.program->sessionClosed("bob");
    EXPECT_EQ(bench.program->subState(), SubState::ready_configured);
    bench.forget();
    bench.program->sessionClosed("alice");
    EXPECT_THAT(bench.observer.log, ElementsAre("sub-state ReadyNotConfigured"));
    EXPECT_EQ(bench.program->read("Speed"), Value(0.5));
    EXPECT_TRUE(bench.program->write(kBob, "Speed", 1.5));
    EXPECT_EQ(bench.executor->timerCount(), 1U);
}

TEST(Binding, EndsTenSecondsAfterTheLastWrite) {
    ProgramBench bench;
    ASSERT_TRUE(bench.program->write(kAlice, "Speed", 1.0));
    bench.executor->advance(6s);
    ASSERT_TRUE(bench.program->write(kAlice, "Seam", std::string("curved")));
    bench.executor->advance(9'999ms);
    EXPECT_EQ(bench.program->subState(), SubState::ready_configured);
    bench.forget();
    bench.executor->advance(1ms);
    EXPECT_THAT(bench.observer.log, ElementsAre("sub-state ReadyNotConfigured"));
    EXPECT_EQ(bench.program->read("Speed"), Value(0.5));
    EXPECT_EQ(bench.program->read("Seam"), Value(std::string("straight")));
    EXPECT_EQ(bench.program->start(kAlice).has_value(), true);
    EXPECT_EQ(bench.script->snapshot.at("Speed"), Value(0.5));
}

TEST(Binding, HasTheTimeoutOfItsOptions) {
    ProgramBench bench({.configuration_timeout = 50ms});
    ASSERT_TRUE(bench.program->write(kAlice, "Speed", 1.0));
    bench.executor->advance(50ms);
    EXPECT_EQ(bench.program->subState(), SubState::ready_not_configured);
}

TEST(Binding, EndsWithHaltByWhomever) {
    ProgramBench bench;
    ASSERT_TRUE(bench.program->write(kAlice, "Speed", 1.0));
    ASSERT_TRUE(bench.program->halt(kBob));
    ASSERT_TRUE(bench.program->reset(kBob));
    EXPECT_EQ(bench.program->read("Speed"), Value(0.5));
    EXPECT_TRUE(bench.program->write(kBob, "Speed", 1.5));
}

TEST(Binding, OfASessionWithoutIdBinds) {
    ProgramBench bench;
    ASSERT_TRUE(bench.program->write({}, "Speed", 1.0));
    EXPECT_EQ(bench.program->write(kBob, "Speed", 1.5).error().code, Errc::locked);
    EXPECT_TRUE(bench.program->start({}));
}

TEST(RequiredParameter, IsMissedAtStartByName) {
    auto description = weldDescription();
    description.parameters.push_back({.name = "Target", .type = ValueType::frame});
    description.parameters.push_back({.name = "Part", .type = ValueType::text});
    description.parameters.push_back({.name = "Note", .type = ValueType::text, .optional = true});
    ProgramBench bench({}, description);
    const auto refused = bench.program->start(kAlice);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, Errc::invalid_argument);
    EXPECT_EQ(refused.error().message, "a value is needed for Target, Part");
    ASSERT_TRUE(bench.program->write(kAlice, "Target", Frame{.x = 0.4}));
    ASSERT_TRUE(bench.program->write(kAlice, "Part", std::string("bolt")));
    EXPECT_TRUE(bench.program->start(kAlice));
    EXPECT_EQ(bench.script->snapshot.at("Target"), Value(Frame{.x = 0.4}));
    EXPECT_EQ(bench.script->snapshot.at("Note"), Value{});
}

TEST(LiveParameter, GoesToTheRunningWorkAndIsChecked) {
    ProgramBench bench;
    bench.enter(State::running);
    ASSERT_TRUE(bench.program->write(kAlice, "Offset", 0.05));
    EXPECT_EQ(bench.program->write(kAlice, "Offset", 0.2).error().code, Errc::out_of_range);
    EXPECT_THAT(bench.script->calls, ElementsAre("Offset = 0.05"));
    EXPECT_EQ(bench.program->read("Offset"), Value(0.05));
}

TEST(LiveParameter, OfNullIsTheDefaultForTheWork) {
    ProgramBench bench;
    bench.enter(State::running);
    ASSERT_TRUE(bench.program->write(kAlice, "Offset", Value{}));
    EXPECT_THAT(bench.script->calls, ElementsAre("Offset = 0"));
}

TEST(LiveParameter, IsTakenOnlyFromTheSessionThatStarted) {
    ProgramBench bench;
    bench.enter(State::running);
    EXPECT_EQ(bench.program->write(kBob, "Offset", 0.05).error().code, Errc::locked);
    EXPECT_THAT(bench.script->calls, IsEmpty());
}

TEST(LiveParameter, IsRefusedByTheWorkWithItsReason) {
    ProgramBench bench;
    bench.enter(State::running);
    bench.script->input_taken = metier::fail(Errc::out_of_range, "jump of 0.08 m");
    EXPECT_EQ(bench.program->write(kAlice, "Offset", 0.08).error().message, "jump of 0.08 m");
    EXPECT_EQ(bench.program->read("Offset"), Value(0.0));
}

TEST(LiveParameter, IsNotTakenWhileStopping) {
    ProgramBench bench;
    bench.enter(State::running);
    ASSERT_TRUE(bench.program->suspend(kAlice));
    EXPECT_EQ(bench.program->write(kAlice, "Offset", 0.05).error().code, Errc::invalid_state);
}

TEST(LiveParameter, FallsBackAtTheEnd) {
    ProgramBench bench;
    bench.enter(State::running);
    ASSERT_TRUE(bench.program->write(kAlice, "Offset", 0.05));
    bench.script->execution.finish();
    bench.run();
    EXPECT_EQ(bench.program->read("Offset"), Value(0.0));
    EXPECT_EQ(bench.program->subState(), SubState::ready_not_configured);
}

TEST(Diagnostic, TellsWhoMadeTheProgramAndWhen) {
    const ProgramBench bench({.creator = {"session 7", "Cell loader", "root"}});
    const auto& diagnostic = bench.program->diagnostic();
    EXPECT_EQ(diagnostic.create_session_id, "session 7");
    EXPECT_EQ(diagnostic.create_client_name, "Cell loader");
    EXPECT_EQ(diagnostic.invocation_creation_time, bench.executor->clock().utcNow());
    EXPECT_EQ(diagnostic.last_method_call, "");
    EXPECT_EQ(diagnostic.last_transition_time, UtcTime{});
}

TEST(Diagnostic, TellsTheLastCallWithItsArgumentsAndStatus) {
    ProgramBench bench;
    ASSERT_TRUE(bench.program->write(kAlice, "Speed", 1.0));
    bench.executor->advance(2s);
    const auto called = bench.executor->clock().utcNow();
    ASSERT_TRUE(bench.program->start(kAlice));
    const auto& diagnostic = bench.program->diagnostic();
    EXPECT_EQ(diagnostic.last_method_call, "Start");
    EXPECT_EQ(diagnostic.last_method_session_id, "alice");
    EXPECT_EQ(diagnostic.last_method_client_name, "Alice's client");
    EXPECT_EQ(diagnostic.last_method_inputs, (ValueMap{{"Speed", 1.0}}));
    EXPECT_EQ(diagnostic.last_method_call_time, called);
    EXPECT_TRUE(diagnostic.last_method_status);
    EXPECT_EQ(diagnostic.last_transition_time, called);
}

TEST(Diagnostic, TellsARefusedCallToo) {
    ProgramBench bench;
    ASSERT_TRUE(bench.program->write(kAlice, "Speed", 1.0));
    EXPECT_FALSE(bench.program->start(kBob));
    const auto& diagnostic = bench.program->diagnostic();
    EXPECT_EQ(diagnostic.last_method_session_id, "bob");
    ASSERT_FALSE(diagnostic.last_method_status);
    EXPECT_EQ(diagnostic.last_method_status.error().code, Errc::locked);
    EXPECT_EQ(diagnostic.last_transition_time, UtcTime{});
    ASSERT_TRUE(bench.program->halt(kBob));
    EXPECT_TRUE(diagnostic.last_method_status);
    EXPECT_THAT(diagnostic.last_method_inputs, IsEmpty());
}

TEST(Diagnostic, IsCompleteBeforeItsEvent) {
    ProgramBench bench;
    std::string call;
    UtcTime transition{};
    bench.executor->advance(1s);
    bench.observer.on_entry = [&](const std::string& entry) {
        if (entry == "ReadyToRunning") {
            call = bench.program->diagnostic().last_method_call;
            transition = bench.program->diagnostic().last_transition_time;
        }
    };
    ASSERT_TRUE(bench.program->start(kAlice));
    EXPECT_EQ(call, "Start");
    EXPECT_EQ(transition, bench.observer.events[0].time);
}

TEST(Binding, OfAnExecutionThatRunsHasNoTimeoutLeft) {
    ProgramBench bench;
    ASSERT_TRUE(bench.program->write(kAlice, "Speed", 1.0));
    ASSERT_TRUE(bench.program->start(kAlice));
    EXPECT_EQ(bench.executor->timerCount(), 0U);
    bench.executor->advance(1min);
    EXPECT_EQ(bench.program->subState(), SubState::executing);
}

TEST(Binding, IsNobodysOnceItIsReleased) {
    ParameterSet set(weldDescription().parameters);
    set.bind("alice");
    EXPECT_TRUE(set.isBoundTo("alice"));
    set.release();
    EXPECT_FALSE(set.isBound());
    EXPECT_FALSE(set.isBoundTo("alice"));
}

TEST(LiveParameter, IsNotTakenWhileAnotherClientHasControl) {
    const auto executor = std::make_shared<ManualExecutor>();
    const auto control = std::make_shared<Control>(executor, executor->clock());
    ProgramBench bench({.control = control}, weldDescription(), executor);
    bench.enter(State::running);
    ASSERT_TRUE(control->acquire(kBob, 0ms, OwnerLossAction::halt));
    EXPECT_EQ(bench.program->write(kAlice, "Offset", 0.05).error().code, Errc::locked);
    EXPECT_THAT(bench.script->calls, IsEmpty());
}

TEST(LiveParameter, ThatIsRefusedIsToldToTheWorkAsWell) {
    ProgramBench bench;
    bench.enter(State::running);
    EXPECT_FALSE(bench.program->write(kAlice, "Offset", 0.2));
    EXPECT_THAT(bench.script->refusals,
                ElementsAre("Offset refused: Offset: 0.2 m is over the limit 0.1 m"));
}

TEST(LiveParameter, WithoutADefaultIsNotTakenAsNull) {
    auto description = weldDescription();
    description.parameters.push_back(
        {.name = "Arc", .type = ValueType::number, .input = Input::live});
    ProgramBench bench({}, description);
    ASSERT_TRUE(bench.program->startWith(kAlice, {.parameters = {{"Arc", 3.0}}}));
    bench.forget();
    EXPECT_EQ(bench.program->write(kAlice, "Arc", Value{}).error().code, Errc::invalid_argument);
    EXPECT_THAT(bench.script->refusals, ElementsAre("Arc refused: Arc: a value is needed"));
    EXPECT_THAT(bench.script->calls, IsEmpty());
}

TEST(LiveParameter, ComesWithTheTimeThatItIsMeantFor) {
    ProgramBench bench;
    bench.enter(State::running);
    const auto meant_for = bench.executor->clock().utcNow() + 20ms;
    ASSERT_TRUE(bench.program->write(kAlice, "Offset", 0.05, meant_for));
    EXPECT_EQ(bench.script->meant_for, meant_for);
}

TEST(ParameterWrite, OfAParameterThatIsNotLiveIsRefusedWhileItRuns) {
    ProgramBench bench;
    bench.enter(State::running);
    EXPECT_EQ(bench.program->write(kAlice, "Speed", 1.0).error().message,
              "Speed cannot be written while Running");
}

}  // namespace
}  // namespace metier::skill::testing
