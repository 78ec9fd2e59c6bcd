#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stdexcept>

#include "program_bench.hpp"

namespace metier::skill::testing {
namespace {

using namespace std::chrono_literals;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

TEST(Start, RefusedBySkillChangesNothingAndLeavesItUsable) {
    ProgramBench bench;
    ASSERT_TRUE(bench.program->write(kAlice, "Speed", 1.0));
    bench.forget();
    bench.script->prepared = metier::fail(Errc::unreachable, "x 2.4 m, reach 0.85 m");
    const auto refused = bench.program->start(kAlice);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, Errc::unreachable);
    EXPECT_EQ(bench.program->state(), State::ready);
    EXPECT_EQ(bench.program->subState(), SubState::ready_configured);
    EXPECT_EQ(bench.program->read("Speed"), Value(1.0));
    EXPECT_THAT(bench.observer.log, ElementsAre("diagnostic Start"));
    bench.script->prepared = {};
    EXPECT_TRUE(bench.program->start(kAlice));
}

TEST(Start, RefusedWhileHaltedSaysWhyItHaltedAndWhatToDo) {
    ProgramBench bench;
    bench.enter(State::running);
    bench.script->execution.fail(Reason::error, "axis 2 is hot: 91 °C");
    bench.run();
    const auto refused = bench.program->startWith(kAlice, {"next"});
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().message,
              "StartWith is not possible while Halted (Error: axis 2 is hot: 91 °C); Reset makes "
              "it Ready");
    EXPECT_EQ(bench.program->write(kAlice, "Speed", 1.0).error().message,
              "Speed cannot be written while Halted (Error: axis 2 is hot: 91 °C); Reset makes it "
              "Ready");
    EXPECT_EQ(bench.program->reasonText(), "axis 2 is hot: 91 °C");
}

TEST(Failure, ThrownByStartStopsTheDeviceAndHalts) {
    ProgramBench bench;
    bench.script->on_start = [](const ExecutionHandle&) { throw std::runtime_error("no current"); };
    EXPECT_TRUE(bench.program->start(kAlice));
    EXPECT_THAT(bench.observer.transitions(), ElementsAre("ReadyToRunning", "RunningToHalted"));
    EXPECT_EQ(bench.program->subState(), SubState::halted_error);
    EXPECT_EQ(bench.program->reasonText(), "no current");
    EXPECT_THAT(bench.script->calls, ElementsAre("start", "forceStop", "destroyed"));
}

TEST(Failure, ThrownByHaltStopsTheDeviceAndHalts) {
    ProgramBench bench;
    bench.enter(State::running);
    bench.script->on_stop = [](const ExecutionHandle&) {
        throw std::runtime_error("brake broken");
    };
    EXPECT_TRUE(bench.program->halt(kAlice));
    EXPECT_EQ(bench.program->subState(), SubState::halted_error);
    EXPECT_THAT(bench.script->calls, ElementsAre("halt", "forceStop", "destroyed"));
    EXPECT_EQ(bench.executor->timerCount(), 0U);
}

TEST(Failure, ThrownBySuspendRefusesIt) {
    ProgramBench bench;
    bench.enter(State::running);
    bench.script->on_stop = [](const ExecutionHandle&) { throw 7; };
    const auto refused = bench.program->suspend(kAlice);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, Errc::internal);
    EXPECT_EQ(bench.program->subState(), SubState::executing);
}

TEST(Failure, ThrownWhileGivingUpASuspendedExecutionStopsTheDevice) {
    ProgramBench bench;
    bench.enter(State::suspended);
    bench.script->on_stop = [](const ExecutionHandle&) {
        throw std::runtime_error("brake broken");
    };
    EXPECT_TRUE(bench.program->halt(kAlice));
    EXPECT_THAT(bench.script->calls, ElementsAre("halt", "forceStop", "destroyed"));
    EXPECT_EQ(bench.program->state(), State::halted);
}

TEST(Failure, AfterTheEndIsIgnored) {
    ProgramBench bench;
    bench.enter(State::running);
    const auto late = bench.script->execution;
    late.finish();
    late.finish();
    late.fail(Reason::error, "too late");
    bench.run();
    EXPECT_THAT(bench.observer.transitions(), ElementsAre("RunningToReady"));
    bench.enter(State::running);
    late.fail(Reason::error, "much too late");
    late.finish();
    late.atRest();
    late.progress(1.0);
    late.step("ghost");
    bench.run();
    EXPECT_EQ(bench.program->state(), State::running);
    EXPECT_THAT(bench.observer.log, IsEmpty());
}

TEST(DeviceLost, WhileSuspendedHaltsAtOnce) {
    ProgramBench bench;
    bench.enter(State::suspended);
    bench.program->deviceLost("cable pulled");
    EXPECT_THAT(bench.observer.transitions(), ElementsAre("SuspendedToHalted"));
    EXPECT_EQ(bench.program->subState(), SubState::halted_device_lost);
    EXPECT_EQ(bench.script->bodies_alive, 0);
}

TEST(DeviceLost, WhileStoppingHaltsAtOnce) {
    ProgramBench bench;
    bench.enter(State::running);
    ASSERT_TRUE(bench.program->halt(kAlice));
    bench.program->deviceLost("cable pulled");
    EXPECT_EQ(bench.program->subState(), SubState::halted_device_lost);
    EXPECT_EQ(bench.executor->timerCount(), 0U);
}

TEST(DeviceNotReady, HaltsWhatIsReadyAndLeavesWhatRunsToItsMotion) {
    ProgramBench bench;
    bench.program->deviceNotReady("fence opened");
    EXPECT_EQ(bench.program->state(), State::halted);
    EXPECT_EQ(bench.program->subState(), SubState::halted_error);
    EXPECT_EQ(bench.program->reasonText(), "fence opened");
    ASSERT_TRUE(bench.program->reset(kAlice));
    ASSERT_TRUE(bench.program->start(kAlice));
    bench.program->deviceNotReady("fence opened");
    EXPECT_EQ(bench.program->state(), State::running);
}

TEST(DeviceNotReady, WhileSomethingRunsHaltsItOnceItIsReady) {
    ProgramBench bench;
    bench.enter(State::running);
    bench.program->deviceNotReady("protective stop");
    EXPECT_EQ(bench.program->state(), State::running);
    bench.script->execution.finish();
    bench.run();
    EXPECT_THAT(bench.observer.transitions(), ElementsAre("RunningToReady", "ReadyToHalted"));
    EXPECT_EQ(bench.program->subState(), SubState::halted_error);
    EXPECT_EQ(bench.program->reasonText(), "protective stop");
    EXPECT_TRUE(bench.program->reset(kAlice));
    EXPECT_EQ(bench.program->state(), State::ready);
}

TEST(DeviceNotReady, WhileSuspendedHaltsItOnceItIsGivenUp) {
    ProgramBench bench;
    bench.enter(State::suspended);
    bench.program->deviceNotReady("protective stop");
    ASSERT_TRUE(bench.program->reset(kAlice));
    EXPECT_THAT(bench.observer.transitions(), ElementsAre("SuspendedToReady", "ReadyToHalted"));
}

TEST(DeviceNotReady, IsOverOnceTheDeviceIsReadyAgain) {
    ProgramBench bench;
    bench.enter(State::running);
    bench.program->deviceNotReady("protective stop");
    bench.program->deviceReady();
    bench.script->execution.finish();
    bench.run();
    EXPECT_EQ(bench.program->state(), State::ready);
}

TEST(DeviceNotReady, IsForgottenWithTheHaltThatFollows) {
    ProgramBench bench;
    bench.enter(State::running);
    bench.program->deviceNotReady("protective stop");
    bench.script->execution.fail(Reason::error, "protective stop");
    bench.run();
    ASSERT_TRUE(bench.program->reset(kAlice));
    EXPECT_EQ(bench.program->state(), State::ready);
}

TEST(DeviceLost, WhileHaltedChangesTheSubStateWithoutATransition) {
    ProgramBench bench;
    bench.enter(State::halted);
    bench.program->deviceLost("cable pulled");
    EXPECT_THAT(bench.observer.log, ElementsAre("sub-state HaltedDeviceLost"));
    EXPECT_EQ(bench.program->reason(), Reason::device_lost);
    EXPECT_EQ(bench.program->reasonText(), "cable pulled");
    EXPECT_EQ(bench.program->state(), State::halted);
}

TEST(DeviceLost, WhileReadyEndsTheConfiguration) {
    ProgramBench bench;
    ASSERT_TRUE(bench.program->write(kAlice, "Speed", 1.0));
    bench.program->deviceLost("cable pulled");
    ASSERT_TRUE(bench.program->reset(kBob));
    EXPECT_EQ(bench.program->read("Speed"), Value(0.5));
    EXPECT_TRUE(bench.program->start(kBob));
}

TEST(DeviceStopped, HaltsWhatRunsOnceItRests) {
    ProgramBench bench;
    bench.enter(State::running);
    bench.program->deviceStopped("nobody watched");
    EXPECT_EQ(bench.program->subState(), SubState::stopping);
    bench.script->execution.atRest();
    bench.run();
    EXPECT_EQ(bench.program->subState(), SubState::halted_error);
    EXPECT_EQ(bench.program->reasonText(), "nobody watched");
    EXPECT_THAT(bench.script->calls, ElementsAre("halt", "destroyed"));
}

TEST(DeviceStopped, IsTheCauseOfAFailureThatFollows) {
    ProgramBench bench;
    bench.enter(State::running);
    bench.program->deviceStopped("nobody watched");
    bench.script->execution.fail(Reason::error, "stopped from outside");
    bench.run();
    EXPECT_EQ(bench.program->reasonText(), "stopped from outside (nobody watched)");
}

TEST(DeviceStopped, MattersOnlyWhileSomethingMoves) {
    for (const auto state : {State::halted, State::ready, State::suspended}) {
        ProgramBench bench;
        bench.enter(state);
        bench.program->deviceStopped("nobody watched");
        EXPECT_EQ(bench.program->state(), state);
        EXPECT_THAT(bench.observer.log, IsEmpty());
    }
}

TEST(OwnerLost, MattersOnlyWhileSomethingMoves) {
    for (const auto state : {State::halted, State::ready, State::suspended}) {
        ProgramBench bench;
        bench.enter(state);
        bench.program->ownerLost("session closed");
        EXPECT_EQ(bench.program->state(), state);
        EXPECT_THAT(bench.observer.log, IsEmpty());
    }
}

TEST(OwnerLost, TurnsASuspendThatIsUnderWayIntoAHalt) {
    ProgramBench bench;
    bench.enter(State::running);
    ASSERT_TRUE(bench.program->suspend(kAlice));
    bench.program->ownerLost("session closed");
    bench.script->execution.atRest();
    bench.run();
    EXPECT_EQ(bench.program->subState(), SubState::halted_owner_lost);
}

TEST(OwnerLost, DoesNotReplaceTheReasonOfAHaltThatIsUnderWay) {
    ProgramBench bench;
    bench.enter(State::running);
    ASSERT_TRUE(bench.program->halt(kAlice));
    bench.program->ownerLost("session closed");
    bench.script->execution.atRest();
    bench.run();
    EXPECT_EQ(bench.program->subState(), SubState::halted_by_client);
}

TEST(Resource, IsHeldFromStartUntilTheEndAlsoWhileSuspended) {
    const auto arm = std::make_shared<Resource>("arm ur5");
    ProgramBench one({.resource = arm});
    ProgramBench two({.resource = arm});
    one.enter(State::suspended);
    EXPECT_FALSE(two.program->executable(Method::start, kBob));
    const auto refused = two.program->start(kBob);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, Errc::resource_unavailable);
    EXPECT_EQ(refused.error().message, "arm ur5 is in use by WeldSkill");
    EXPECT_EQ(two.program->state(), State::ready);
    ASSERT_TRUE(one.program->reset(kAlice));
    EXPECT_TRUE(two.program->executable(Method::start, kBob));
    EXPECT_TRUE(two.program->start(kBob));
}

TEST(Resource, IsFreeAfterEveryEnd) {
    const auto arm = std::make_shared<Resource>("arm");
    const auto freed = [&](auto end) {
        ProgramBench bench({.resource = arm});
        bench.enter(State::running);
        EXPECT_EQ(arm->holder(), "WeldSkill");
        end(bench);
        bench.run();
        return arm->checkFree().has_value();
    };
    EXPECT_TRUE(freed([](ProgramBench& bench) { bench.script->execution.finish(); }));
    EXPECT_TRUE(
        freed([](ProgramBench& bench) { bench.script->execution.fail(Reason::error, ""); }));
    EXPECT_TRUE(freed([](ProgramBench& bench) { bench.program->deviceLost(""); }));
    EXPECT_TRUE(freed([](ProgramBench& bench) { bench.program.reset(); }));
    EXPECT_TRUE(freed([](ProgramBench& bench) {
        static_cast<void>(bench.program->halt(kAlice));
        bench.script->execution.atRest();
    }));
}

TEST(Resource, IsNotTakenByAStartThatWasRefused) {
    const auto arm = std::make_shared<Resource>("arm");
    ProgramBench bench({.resource = arm});
    bench.script->prepared = metier::fail(Errc::unreachable, "too far");
    EXPECT_FALSE(bench.program->start(kAlice));
    EXPECT_TRUE(arm->checkFree());
}

TEST(Resource, IsNotFreedByAnotherProgramsHaltOrEnd) {
    const auto arm = std::make_shared<Resource>("arm");
    ProgramBench one({.resource = arm});
    ProgramBench two({.resource = arm});
    one.enter(State::running);
    EXPECT_TRUE(two.program->halt(kBob));
    two.program.reset();
    EXPECT_FALSE(arm->checkFree());
}

TEST(ResourceAlone, IsAcquiredOnceAtATime) {
    Resource arm("arm");
    EXPECT_TRUE(arm.acquire("first"));
    const auto refused = arm.acquire("second");
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, Errc::resource_unavailable);
    EXPECT_EQ(arm.holder(), "first");
    arm.release();
    EXPECT_TRUE(arm.acquire("second"));
}

TEST(ProgramEnd, WhileRunningStopsTheDeviceAndTellsNothing) {
    ProgramBench bench;
    bench.enter(State::running);
    bench.program.reset();
    EXPECT_THAT(bench.script->calls, ElementsAre("forceStop", "destroyed"));
    EXPECT_THAT(bench.observer.log, IsEmpty());
}

TEST(ProgramEnd, LeavesItsExecutionsHarmless) {
    ProgramBench bench;
    bench.enter(State::running);
    const auto orphan = bench.script->execution;
    orphan.finish();
    bench.program.reset();
    orphan.fail(Reason::error, "nobody listens");
    orphan.atRest();
    bench.run();
    bench.executor.reset();
    orphan.progress(1.0);
    EXPECT_FALSE(orphan.id().empty());
}

TEST(ProgramEnd, CancelsItsTimers) {
    ProgramBench bench;
    ASSERT_TRUE(bench.program->write(kAlice, "Speed", 1.0));
    EXPECT_EQ(bench.executor->timerCount(), 1U);
    bench.program.reset();
    EXPECT_EQ(bench.executor->timerCount(), 0U);
    bench.executor->advance(1h);
}

TEST(EmptyExecution, IgnoresEveryCall) {
    const ExecutionHandle nobody;
    nobody.finish();
    nobody.fail(Reason::error, "");
    nobody.atRest();
    nobody.progress(1.0);
    nobody.step("one");
    EXPECT_EQ(nobody.id(), "");
}

TEST(Observer, MayReadButNotCommandFromInsideANotification) {
    ProgramBench bench;
    Result<void> started{};
    Result<void> written{};
    State seen{};
    bench.observer.on_entry = [&](const std::string& entry) {
        if (entry == "ReadyToHalted") {
            started = bench.program->start(kAlice);
            written = bench.program->write(kAlice, "Speed", 1.0);
            seen = bench.program->state();
        }
    };
    ASSERT_TRUE(bench.program->halt(kAlice));
    ASSERT_FALSE(started);
    EXPECT_EQ(started.error().code, Errc::invalid_state);
    EXPECT_THAT(started.error().message, HasSubstr("notification"));
    EXPECT_FALSE(written);
    EXPECT_EQ(seen, State::halted);
    EXPECT_EQ(bench.program->diagnostic().last_method_call, "Halt");
}

TEST(Observer, WhatArrivesInsideANotificationFollowsIt) {
    ProgramBench bench;
    bench.observer.on_entry = [&](const std::string& entry) {
        if (entry == "ReadyToRunning") {
            bench.program->deviceLost("lost during Start");
            EXPECT_EQ(bench.program->state(), State::running);
        }
    };
    ASSERT_TRUE(bench.program->start(kAlice));
    EXPECT_THAT(bench.observer.transitions(), ElementsAre("ReadyToRunning", "RunningToHalted"));
    EXPECT_THAT(bench.script->calls, ElementsAre("start", "forceStop", "destroyed"));
}

TEST(Observer, OneOfSeveralCanLeave) {
    ProgramBench bench;
    RecordingObserver second;
    bench.program->attach(second);
    ASSERT_TRUE(bench.program->halt(kAlice));
    EXPECT_EQ(second.log, bench.observer.log);
    bench.program->detach(second);
    ASSERT_TRUE(bench.program->reset(kAlice));
    EXPECT_EQ(second.events.size(), 1U);
    EXPECT_EQ(bench.observer.events.size(), 2U);
}

TEST(ProgramWiring, RefusesFieldsThatContradictThemselves) {
    const auto make = [](SkillDescription description) {
        const ProgramBench bench({}, std::move(description));
    };
    EXPECT_THROW(make({.parameters = {{.name = "A"}, {.name = "A"}}}), std::invalid_argument);
    EXPECT_THROW(make({.parameters = {{.name = "A",
                                       .type = ValueType::number,
                                       .range = Range{0, 1},
                                       .default_value = 2.0}}}),
                 std::invalid_argument);
    const auto executor = std::make_shared<ManualExecutor>();
    EXPECT_THROW(Program({}, nullptr, executor, executor->clock()), std::invalid_argument);
}

/// Runs posted work inside post(), against its contract.
class HastyExecutor final : public Executor {
public:
    void post(std::function<void()> work) override { work(); }
    Timer after(std::chrono::nanoseconds /*delay*/, std::function<void()> /*work*/) override {
        return Timer{};
    }
};

TEST(HastyExecutor, StillGetsRunningBeforeReady) {
    const auto script = std::make_shared<Script>();
    script->on_start = [](const ExecutionHandle& execution) { execution.finish(); };
    const ManualClock clock;
    Program program({}, std::make_unique<ScriptedSkill>(weldDescription(), script),
                    std::make_shared<HastyExecutor>(), clock);
    RecordingObserver observer;
    program.attach(observer);
    ASSERT_TRUE(program.start(kAlice));
    EXPECT_THAT(observer.transitions(), ElementsAre("ReadyToRunning", "RunningToReady"));
    EXPECT_THAT(script->calls, ElementsAre("start", "destroyed"));
}

TEST(HastyExecutor, TakesNothingMoreOnceTheWorkHasEnded) {
    const auto script = std::make_shared<Script>();
    script->on_start = [](const ExecutionHandle& execution) {
        execution.finish({{"Length", 0.4}});
        execution.finish({{"Length", 0.6}});
        execution.fail(Reason::error, "late");
        execution.suspend("late");
        execution.atRest();
        execution.step("late");
    };
    const ManualClock clock;
    Program program({}, std::make_unique<ScriptedSkill>(weldDescription(), script),
                    std::make_shared<HastyExecutor>(), clock);
    RecordingObserver observer;
    program.attach(observer);
    ASSERT_TRUE(program.start(kAlice));
    EXPECT_THAT(observer.transitions(), ElementsAre("ReadyToRunning", "RunningToReady"));
    EXPECT_EQ(program.finalResult().at("Length"), Value(0.4));
    EXPECT_THAT(script->calls, ElementsAre("start", "destroyed"));
    EXPECT_THAT(observer.stops, IsEmpty());
}

TEST(ProgramEnd, WhileSuspendedLeavesTheDeviceWhichStands) {
    ProgramBench bench;
    bench.enter(State::suspended);
    bench.program.reset();
    EXPECT_THAT(bench.script->calls, ElementsAre("destroyed"));
}

TEST(DeviceStopped, LeavesAHaltThatIsUnderWayItsReason) {
    ProgramBench bench;
    bench.enter(State::running);
    ASSERT_TRUE(bench.program->halt(kAlice));
    bench.program->deviceStopped("nobody watched");
    EXPECT_THAT(bench.script->calls, ElementsAre("halt"));
    bench.script->execution.atRest();
    bench.run();
    EXPECT_EQ(bench.program->subState(), SubState::halted_by_client);
    EXPECT_EQ(bench.program->reasonText(), "");
}

TEST(Start, RefusedWhileHaltedByAClientSaysSo) {
    ProgramBench bench;
    bench.enter(State::halted);
    EXPECT_EQ(bench.program->start(kAlice).error().message,
              "Start is not possible while Halted (ByClient); Reset makes it Ready");
}

TEST(Start, WhileItRunsIsRefusedWithTheStateAlone) {
    ProgramBench bench;
    bench.enter(State::running);
    EXPECT_EQ(bench.program->start(kAlice).error().message, "Start is not possible while Running");
}

class SkillWithoutWork final : public Skill {
public:
    const SkillDescription& description() const override { return description_; }
    Result<std::unique_ptr<ExecutionWork>> prepare(const ValueMap& /*snapshot*/) override {
        return std::unique_ptr<ExecutionWork>();
    }

private:
    SkillDescription description_{.name = "EmptySkill"};
};

TEST(Start, OfASkillThatMakesNoWorkIsRefusedAndLeavesItReady) {
    const auto executor = std::make_shared<ManualExecutor>();
    Program program({}, std::make_unique<SkillWithoutWork>(), executor, executor->clock());
    EXPECT_EQ(program.start(kAlice).error().code, Errc::internal);
    EXPECT_EQ(program.state(), State::ready);
}

TEST(ProgramWiring, RefusesResultsThatContradictThemselves) {
    const auto make = [](SkillDescription description) {
        const ProgramBench bench({}, std::move(description));
    };
    EXPECT_THROW(make({.results = {{.name = "A"}, {.name = "B"}, {.name = "A"}}}),
                 std::invalid_argument);
    EXPECT_NO_THROW(make({.parameters = {{.name = "A"}}, .results = {{.name = "A"}}}));
}

}  // namespace
}  // namespace metier::skill::testing
