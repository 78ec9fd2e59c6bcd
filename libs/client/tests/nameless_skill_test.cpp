// SkillHandle at a Program that names no executions and sends no events.
#include <gmock/gmock.h>

#include <future>
#include <optional>

#include "metier/client/async_skill.hpp"
#include "metier/client/skill_handle.hpp"
#include "metier/opcua/event_emitter.hpp"
#include "served_nodes.hpp"

namespace metier::client {
namespace {

using namespace std::chrono_literals;
using opcua::Value;
using skill::State;
using ::testing::HasSubstr;

SteadyTime in(std::chrono::milliseconds time) {
    return std::chrono::steady_clock::now() + time;
}

/// A lamp that goes on and off by Methods, so that its state changes on the server's thread.
class NamelessSkill : public ::testing::Test {
protected:
    NamelessSkill() {
        lamp_.name = "Lamp";
        lamp_.node = served_.program(opcua::ids::kObjectsFolder, lamp_.name);
        const auto current = served_.variable(lamp_.node, {0, "CurrentState"}, Value::of("Ready"));
        state_ = served_.variable(current, {0, "Number"}, Value::of(number(State::ready)));
        const auto last = served_.variable(lamp_.node, {0, "LastTransition"}, Value::of(""));
        last_ = served_.variable(last, {0, "Number"}, Value::of(0U));
        addMethod("Start", State::running, 2);
        end_ = addMethod("End", State::ready, 4);
        give_up_ = addMethod("GiveUp", State::ready, 8);
    }

    static std::uint32_t number(State state) { return static_cast<std::uint32_t>(state); }
    opcua::NodeId addMethod(const std::string& name, State to, std::uint32_t transition) {
        const auto method = served_.method(lamp_.node, name);
        EXPECT_TRUE(served_.nodes().setMethod(
            method,
            [this, to, transition](const auto& /*caller*/,
                                   auto /*inputs*/) -> Result<std::vector<Value>> {
                METIER_TRY(served_.nodes().write(last_, Value::of(transition)));
                METIER_TRY(served_.nodes().write(state_, Value::of(number(to))));
                return std::vector<Value>();
            }));
        return method;
    }
    void call(const opcua::NodeId& method) {
        ASSERT_TRUE(served_.client().call(lamp_.node, method));
    }
    SkillHandle open() { return std::move(SkillHandle::open(served_.client(), lamp_).value()); }

    testing::ServedNodes served_;
    SkillAddress lamp_;
    opcua::NodeId state_;
    opcua::NodeId last_;
    opcua::NodeId end_;
    opcua::NodeId give_up_;
};

TEST_F(NamelessSkill, KeepsTheEndOfItsRunForTheNextWhoWaits) {
    auto lamp = open();
    ASSERT_TRUE(lamp.start());
    const auto late = lamp.awaitEnd(in(50ms));
    ASSERT_FALSE(late);
    EXPECT_EQ(late.error().code, Errc::timeout);
    call(end_);
    const auto end = lamp.awaitEnd(in(1min));
    ASSERT_TRUE(end) << end.error().message;
    EXPECT_EQ(end->to, State::ready);
    EXPECT_EQ(end->number, skill::TransitionNumber::running_to_ready);
}

TEST_F(NamelessSkill, ThatIsReadyAndWasNotStartedHereHasNoEnd) {
    auto lamp = open();
    const auto end = lamp.awaitEnd(in(50ms));
    ASSERT_FALSE(end);
    EXPECT_EQ(end.error().code, Errc::timeout);
}

TEST_F(NamelessSkill, GivenUpWhileSuspendedHasNotFinished) {
    auto lamp = open();
    ASSERT_TRUE(lamp.start());
    call(end_);
    ASSERT_TRUE(lamp.awaitEnd(in(1min)));
    ASSERT_TRUE(lamp.start());
    call(give_up_);
    const auto end = lamp.awaitEnd(in(1min));
    ASSERT_TRUE(end) << end.error().message;
    EXPECT_EQ(end->number, skill::TransitionNumber::suspended_to_ready)
        << "the end of the run before is in the log, too";
}

TEST_F(NamelessSkill, SaysWhatItLacks) {
    auto lamp = open();
    const std::vector both{Lack::atomic_start, Lack::dead_man};
    EXPECT_EQ(lamp.lacks(), both);
    EXPECT_EQ(readLacks(served_.client(), lamp_).value(), both);
    EXPECT_EQ(textOf(both), "no atomic start, no dead-man");
    EXPECT_EQ(explanationOf({Lack::dead_man}), "no dead-man (it goes on if its client dies)");
    const auto halted = lamp.halt();
    ASSERT_FALSE(halted);
    EXPECT_EQ(halted.error().code, Errc::not_supported);
    EXPECT_EQ(halted.error().message, "Lamp has no Halt");
    EXPECT_FALSE(lamp.executable(skill::Method::halt).value());
    const auto leased = lamp.startWith({.on_owner_loss = skill::OwnerLossAction::halt});
    ASSERT_FALSE(leased);
    EXPECT_THAT(leased.error().message, HasSubstr("Lamp has no StartWith"));
    EXPECT_EQ(lamp.state().value(), State::ready) << "nothing was started";
}

/// A lamp that breaks: its event, which says why, comes when the test calls for it.
class LampThatBreaks : public ::testing::Test {
protected:
    LampThatBreaks() {
        lamp_.name = "Lamp";
        lamp_.node =
            served_.nodes()
                .addObject({{{}, opcua::ids::kObjectsFolder, opcua::ids::kOrganizes, {1, "Lamp"}},
                            opcua::ids::kProgramStateMachineType,
                            opcua::EventNotifier::subscribable,
                            opcua::Children::none})
                .value();
        served_.variable(lamp_.node, {0, "CurrentState"}, Value::of("Halted"));
        emitter_.emplace(opcua::EventEmitter::create(served_.server(),
                                                     opcua::ids::kTransitionEventType,
                                                     {{{0, "Transition"}}})
                             .value());
        served_.method(lamp_.node, "Start");
        say_ = served_.method(lamp_.node, "SayWhy");
        EXPECT_TRUE(served_.nodes().setMethod(
            say_, [this](const auto& /*caller*/, auto /*in*/) -> Result<std::vector<Value>> {
                METIER_TRY(emitter_->emit(
                    {.source = lamp_.node,
                     .source_name = "Lamp",
                     .time = std::chrono::system_clock::now(),
                     .severity = 100,
                     .message = {"", "the lamp is broken"},
                     .fields = {Value::of(opcua::LocalizedText{"", "RunningToHalted"})}}));
                return std::vector<Value>();
            }));
    }

    testing::ServedNodes served_;
    std::optional<opcua::EventEmitter> emitter_;
    SkillAddress lamp_;
    opcua::NodeId say_;
};

TEST_F(LampThatBreaks, IsReportedWithTheReasonOfAnEventThatComesAfterItsState) {
    auto skill = AsyncSkill::open(served_.client(), lamp_, {});
    ASSERT_TRUE(skill) << skill.error().message;
    std::promise<opcua::Answer<skill::ExecutionRecord>> promise;
    auto record = promise.get_future();
    ASSERT_TRUE(
        skill->execution("any", [&](auto answer) { promise.set_value(std::move(answer)); }));
    ASSERT_TRUE(served_.client().call(lamp_.node, say_));
    const auto told = record.get();
    ASSERT_TRUE(told) << told.error().message;
    EXPECT_EQ(told->state, State::halted);
    EXPECT_EQ(told->reason_text, "the lamp is broken");
}

}  // namespace
}  // namespace metier::client
