#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "program_bench.hpp"

namespace metier::skill::testing {
namespace {

using namespace std::chrono_literals;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// A Program of a controller that clients may take control of.
class Owned : public ::testing::Test {
protected:
    Owned() {
        executor->run();
        program.attach(observer);
    }
    ~Owned() override { program.detach(observer); }
    Owned(const Owned&) = delete;
    Owned& operator=(const Owned&) = delete;

    void rest() {
        script->execution.atRest();
        executor->run();
    }

    std::shared_ptr<ManualExecutor> executor = std::make_shared<ManualExecutor>();
    std::shared_ptr<Control> control = std::make_shared<Control>(executor, executor->clock());
    std::shared_ptr<Script> script = std::make_shared<Script>();
    RecordingObserver observer;
    Program program{{.control = control},
                    std::make_unique<ScriptedSkill>(weldDescription(), script),
                    executor,
                    executor->clock()};
};

TEST_F(Owned, StartWithTakesAllValuesAtOnce) {
    const auto id = program.startWith(
        kAlice, {.execution_id = "seam 7", .parameters = {{"Speed", 1.5}, {"Seam", Value()}}});
    ASSERT_TRUE(id) << id.error().message;
    EXPECT_EQ(*id, "seam 7");
    EXPECT_EQ(script->snapshot.at("Speed"), Value(1.5));
    EXPECT_EQ(script->snapshot.at("Seam"), Value(std::string("straight")));
    EXPECT_EQ(program.read("Speed"), Value(0.5))
        << "the set is what the next execution begins with";
    EXPECT_EQ(observer.events.at(0).execution_id, "seam 7");
    EXPECT_EQ(program.diagnostic().last_method_call, "StartWith");
    EXPECT_EQ(program.diagnostic().last_method_inputs.at("Speed"), Value(1.5));
}

TEST_F(Owned, StartWithDropsWhatTheSessionHasWritten) {
    ASSERT_TRUE(program.write(kAlice, "Speed", 2.0));
    ASSERT_TRUE(program.startWith(kAlice, {.parameters = {{"Seam", std::string("bent")}}}));
    EXPECT_EQ(script->snapshot.at("Speed"), Value(0.5));
}

TEST_F(Owned, StartWithRefusedChangesNothing) {
    ASSERT_TRUE(program.write(kAlice, "Speed", 2.0));
    observer.clear();
    const auto over = program.startWith(kAlice, {.parameters = {{"Speed", 2.5}}});
    ASSERT_FALSE(over);
    EXPECT_EQ(over.error().code, Errc::out_of_range);
    const auto unknown = program.startWith(kAlice, {.parameters = {{"Sped", 1.0}}});
    ASSERT_FALSE(unknown);
    EXPECT_EQ(unknown.error().code, Errc::invalid_argument);
    EXPECT_THAT(unknown.error().message, HasSubstr("Sped"));
    EXPECT_FALSE(program.startWith(kBob, {})) << "another session has configured the skill";
    EXPECT_FALSE(program.startWith(kAlice, {.execution_id = std::string(129, 'x')}));
    EXPECT_EQ(program.read("Speed"), Value(2.0));
    EXPECT_EQ(program.subState(), SubState::ready_configured);
    EXPECT_THAT(observer.events, IsEmpty());
}

TEST_F(Owned, StartWithRepeatedFindsTheExecutionRunningOrOver) {
    const StartRequest request{.execution_id = "seam 7", .parameters = {{"Speed", 1.0}}};
    ASSERT_TRUE(program.startWith(kAlice, request));
    EXPECT_EQ(program.startWith(kBob, request), "seam 7") << "after a reconnect";
    EXPECT_EQ(program.execution("seam 7")->state, State::running);
    script->execution.finish({{"Length", 0.3}});
    executor->run();
    EXPECT_EQ(program.startWith(kBob, request), "seam 7");
    EXPECT_EQ(program.state(), State::ready);
    EXPECT_THAT(observer.transitions(), ElementsAre("ReadyToRunning", "RunningToReady"));
    const auto record = program.execution("seam 7");
    ASSERT_TRUE(record);
    EXPECT_EQ(record->state, State::ready);
    EXPECT_EQ(record->reason, Reason::finished);
    EXPECT_EQ(record->client.client_name, "Alice's client");
    EXPECT_EQ(record->result.at("Length"), Value(0.3));
    EXPECT_FALSE(program.execution("seam 8"));
}

TEST_F(Owned, HistoryKeepsTheLastExecutions) {
    for (std::size_t i = 0; i <= ExecutionHistory::kMost; ++i) {
        ASSERT_TRUE(program.startWith(kAlice, {.execution_id = std::to_string(i)}));
        script->execution.finish();
        executor->run();
    }
    EXPECT_FALSE(program.execution("0"));
    EXPECT_TRUE(program.execution("1"));
    EXPECT_TRUE(program.execution(std::to_string(ExecutionHistory::kMost)));
}

TEST_F(Owned, StartWithAfterItsDeadlineMovesNothing) {
    const auto now = executor->clock().utcNow();
    EXPECT_TRUE(program.startWith(kAlice, {.deadline = now + 1ms}));
    script->execution.finish();
    executor->run();
    observer.clear();
    const auto late = program.startWith(kAlice, {.deadline = now - 20ms});
    ASSERT_FALSE(late);
    EXPECT_EQ(late.error().code, Errc::timeout);
    EXPECT_THAT(late.error().message, HasSubstr("20 ms ago"));
    EXPECT_THAT(observer.events, IsEmpty());
}

TEST_F(Owned, StartWithAStaleEpochMovesNothing) {
    const auto old = control->acquire(kAlice, 0ms, OwnerLossAction::halt);
    const auto epoch = control->acquire(kAlice, 0ms, OwnerLossAction::halt);
    const auto stale = program.startWith(kAlice, {.epoch = *old});
    ASSERT_FALSE(stale);
    EXPECT_EQ(stale.error().code, Errc::locked);
    EXPECT_FALSE(program.startWith(kBob, {.epoch = *epoch}));
    EXPECT_TRUE(program.startWith(kAlice, {.epoch = *epoch}));
}

TEST_F(Owned, OnlyHaltIsLeftToOthersWhileOneHasControl) {
    ASSERT_TRUE(control->acquire(kAlice, 0ms, OwnerLossAction::halt));
    for (const auto& refused : {program.write(kBob, "Speed", 1.0), program.start(kBob)}) {
        ASSERT_FALSE(refused);
        EXPECT_EQ(refused.error().code, Errc::locked);
    }
    EXPECT_FALSE(program.executable(Method::start, kBob));
    EXPECT_TRUE(program.executable(Method::start, kAlice));
    ASSERT_TRUE(program.start(kAlice));
    EXPECT_FALSE(program.suspend(kBob));
    EXPECT_TRUE(program.executable(Method::halt, kBob));
    ASSERT_TRUE(program.halt(kBob));
    rest();
    EXPECT_FALSE(program.reset(kBob));
    EXPECT_TRUE(program.reset(kAlice));
}

TEST_F(Owned, TheEndOfTheLeaseHaltsWhatItsHolderStarted) {
    ASSERT_TRUE(control->acquire(kAlice, 500ms, OwnerLossAction::skill_default));
    ASSERT_TRUE(program.start(kAlice));
    executor->advance(500ms);
    EXPECT_EQ(program.subState(), SubState::stopping);
    rest();
    EXPECT_EQ(program.subState(), SubState::halted_owner_lost);
    EXPECT_EQ(observer.events.back().reason, Reason::owner_lost);
    EXPECT_THAT(observer.events.back().reason_text, HasSubstr("no heartbeat"));
}

TEST_F(Owned, TheStartDecidesBeforeTheLeaseAndTheLeaseBeforeTheSkill) {
    struct Case {
        OwnerLossAction start;
        OwnerLossAction lease;
        State then;
    };
    using enum OwnerLossAction;
    for (const auto& [start, lease, then] :
         {Case{suspend, halt, State::suspended}, Case{skill_default, suspend, State::suspended},
          Case{keep_going, halt, State::running}, Case{skill_default, keep_going, State::running},
          Case{halt, suspend, State::halted}, Case{skill_default, skill_default, State::halted}}) {
        ASSERT_TRUE(control->acquire(kAlice, 500ms, lease));
        ASSERT_TRUE(program.startWith(kAlice, {.on_owner_loss = start}));
        executor->advance(500ms);
        rest();
        EXPECT_EQ(program.state(), then) << toString(start) << ", " << toString(lease);
        if (then != State::running) {
            EXPECT_EQ(program.reason(), Reason::owner_lost);
        }
        ASSERT_TRUE(program.state() == State::halted || program.halt(kBob));
        rest();
        ASSERT_TRUE(program.reset(kBob));
    }
}

TEST_F(Owned, GoesOnIfItsLeaseSaysSoAlsoWhenTheSessionOfItsOwnerEnds) {
    ASSERT_TRUE(control->acquire(kAlice, 500ms, OwnerLossAction::keep_going));
    ASSERT_TRUE(program.startWith(kAlice, {}));
    executor->advance(500ms);
    program.sessionClosed("alice");
    EXPECT_EQ(program.subState(), SubState::executing);
    script->execution.finish();
    executor->run();
    EXPECT_EQ(program.state(), State::ready);
    EXPECT_EQ(program.reason(), Reason::finished);
}

TEST_F(Owned, RefusesACommanderWhoseLeaseRanOutAlsoWithoutAnEpoch) {
    ASSERT_TRUE(control->acquire(kAlice, 500ms, OwnerLossAction::suspend));
    ASSERT_TRUE(program.startWith(kAlice, {}));
    executor->advance(500ms);
    rest();
    ASSERT_EQ(program.state(), State::suspended);
    const auto resumed = program.resume(kAlice);
    ASSERT_FALSE(resumed) << "it may have been on its way since before the loss";
    EXPECT_EQ(resumed.error().code, Errc::locked);
    EXPECT_FALSE(program.executable(Method::resume, kAlice));
    EXPECT_FALSE(program.reset(kAlice));
    EXPECT_TRUE(program.halt(kAlice)) << "Halt is everybody's";
    ASSERT_TRUE(control->acquire(kAlice, 500ms, OwnerLossAction::suspend));
    EXPECT_TRUE(program.reset(kAlice));
}

TEST_F(Owned, TheEndOfItsSessionIsTheLossOfTheOwner) {
    ASSERT_TRUE(program.startWith(kAlice, {.on_owner_loss = OwnerLossAction::suspend}));
    program.sessionClosed("bob");
    EXPECT_EQ(program.subState(), SubState::executing);
    program.sessionClosed("alice");
    rest();
    EXPECT_EQ(program.state(), State::suspended);
    ASSERT_TRUE(program.resume(kBob));
    script->execution.finish();
    executor->run();
    EXPECT_EQ(program.state(), State::ready);
}

TEST_F(Owned, WhoeverResumesAfterTheLossOfTheOwnerIsTheOwner) {
    ASSERT_TRUE(program.startWith(kAlice, {.on_owner_loss = OwnerLossAction::suspend}));
    program.sessionClosed("alice");
    rest();
    ASSERT_EQ(program.state(), State::suspended);
    ASSERT_TRUE(program.resume(kBob));
    EXPECT_TRUE(program.write(kBob, "Offset", 0.01));
    program.sessionClosed("bob");
    rest();
    EXPECT_EQ(program.state(), State::suspended);
}

TEST_F(Owned, ResumeByAnotherLeavesTheOwnerInPlace) {
    ASSERT_TRUE(program.startWith(kAlice, {.on_owner_loss = OwnerLossAction::halt}));
    ASSERT_TRUE(program.suspend(kBob));
    rest();
    ASSERT_TRUE(program.resume(kBob));
    program.sessionClosed("bob");
    EXPECT_EQ(program.subState(), SubState::executing);
    EXPECT_TRUE(program.write(kAlice, "Offset", 0.01));
}

TEST_F(Owned, ASkillThatCannotBeSuspendedIsHalted) {
    auto description = weldDescription();
    description.suspendable = false;
    ProgramBench bench({}, description);
    ASSERT_TRUE(bench.program->startWith(kAlice, {.on_owner_loss = OwnerLossAction::suspend}));
    bench.program->sessionClosed("alice");
    bench.script->execution.atRest();
    bench.run();
    EXPECT_EQ(bench.program->subState(), SubState::halted_owner_lost);
}

TEST_F(Owned, TheEndOfTheLeaseFreesTheParameters) {
    ASSERT_TRUE(control->acquire(kAlice, 500ms, OwnerLossAction::halt));
    ASSERT_TRUE(program.write(kAlice, "Speed", 1.0));
    executor->advance(500ms);
    EXPECT_EQ(program.subState(), SubState::ready_not_configured);
    EXPECT_TRUE(program.write(kBob, "Speed", 1.0));
}

TEST_F(Owned, CheckSaysWhatStartWouldSayAndChangesNothing) {
    EXPECT_TRUE(program.check(kAlice, {{"Speed", 1.0}}).possible);
    const auto over = program.check(kAlice, {{"Speed", 2.5}});
    EXPECT_FALSE(over.possible);
    EXPECT_THAT(over.reason, HasSubstr("2.5"));
    script->prepared = metier::fail(Errc::unreachable, "x 2.4 m, reach 0.85 m");
    const auto far = program.check(kAlice, {});
    EXPECT_FALSE(far.possible);
    EXPECT_EQ(far.reason, "x 2.4 m, reach 0.85 m");
    script->prepared = {};
    ASSERT_TRUE(control->acquire(kAlice, 0ms, OwnerLossAction::halt));
    EXPECT_FALSE(program.check(kBob, {}).possible);
    EXPECT_THAT(observer.log, IsEmpty());
    ASSERT_TRUE(program.start(kAlice));
    EXPECT_THAT(program.check(kAlice, {}).reason, HasSubstr("while Running"));
    EXPECT_EQ(script->bodies_alive, 1);
}

TEST_F(Owned, CheckGivesItsAnswerOnceAndTellsTheKindOfARefusal) {
    int answers = 0;
    CheckReport answer;
    const auto check = [&](const Caller& caller, ValueMap parameters) {
        program.check(caller, {std::move(parameters), {}}, [&](const Result<CheckReport>& report) {
            ++answers;
            answer = report.value();
        });
        return answer;
    };
    EXPECT_TRUE(check(kAlice, {{"Speed", 1.0}}).possible);
    EXPECT_EQ(check(kAlice, {{"Speed", 2.5}}).code, "out_of_range");
    script->prepared = metier::fail(Errc::unreachable, "x 2.4 m, reach 0.85 m");
    EXPECT_EQ(check(kAlice, {}).code, "unreachable");
    EXPECT_EQ(answers, 3);
    script->prepared = metier::fail(Errc::timeout, "not known yet");
    std::string error;
    program.check(kAlice, {}, [&](const Result<CheckReport>& report) {
        error = report ? "an answer" : report.error().message;
    });
    EXPECT_EQ(error, "not known yet");
}

TEST_F(Owned, TheEndOfALeaseLeavesWhatAnotherSessionHasBegunOrConfigured) {
    ASSERT_TRUE(program.start(kBob));
    ASSERT_TRUE(control->acquire(kAlice, 500ms, OwnerLossAction::halt));
    executor->advance(500ms);
    EXPECT_EQ(program.subState(), SubState::executing);
    script->execution.finish();
    executor->run();
    ASSERT_TRUE(program.write(kBob, "Speed", 1.0));
    ASSERT_TRUE(control->acquire(kAlice, 500ms, OwnerLossAction::halt));
    executor->advance(500ms);
    EXPECT_EQ(program.subState(), SubState::ready_configured);
    EXPECT_EQ(program.read("Speed"), Value(1.0));
}

TEST_F(Owned, AnExecutionIdMayHave128Characters) {
    EXPECT_TRUE(program.startWith(kAlice, {.execution_id = std::string(128, 'x')}));
}

TEST_F(Owned, StartWithAtItsVeryDeadlineStillBegins) {
    EXPECT_TRUE(program.startWith(kAlice, {.deadline = executor->clock().utcNow()}));
}

TEST_F(Owned, CheckIsRefusedToAnotherSessionThanTheOneThatConfigures) {
    ASSERT_TRUE(program.write(kAlice, "Speed", 1.0));
    EXPECT_TRUE(program.check(kAlice, {}).possible);
    const auto refused = program.check(kBob, {});
    EXPECT_FALSE(refused.possible);
    EXPECT_THAT(refused.reason, HasSubstr("another session has configured"));
}

TEST(EpochWithoutControl, IsNobodysAndStartsNothing) {
    ProgramBench bench;
    const auto refused = bench.program->startWith(kAlice, {.epoch = 3});
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, Errc::locked);
    EXPECT_THAT(refused.error().message, HasSubstr("epoch 3"));
    EXPECT_EQ(bench.program->state(), State::ready);
    EXPECT_TRUE(bench.program->startWith(kAlice, {.epoch = 0}));
}

}  // namespace
}  // namespace metier::skill::testing
