#include "program_state.hpp"

#include <gtest/gtest.h>

#include <string>

namespace metier::client {
namespace {

using opcua::NodeId;
using opcua::Value;
using skill::State;
using skill::TransitionNumber;

Value id(std::uint32_t number, std::uint16_t name_space = 0) {
    return Value::of(NodeId(name_space, number));
}

Value text(const std::string& name) {
    return Value::of(opcua::LocalizedText{"en", name});
}

TEST(ProgramState, IsNamedByIdByNumberOrByName) {
    const Value none;
    EXPECT_EQ(stateFrom({id(2400), none, none}), State::ready);
    EXPECT_EQ(stateFrom({id(2406), none, none}), State::halted);
    EXPECT_EQ(stateFrom({none, Value::of(std::uint32_t{13}), none}), State::running);
    EXPECT_EQ(stateFrom({none, none, text("Suspended")}), State::suspended);
    EXPECT_EQ(stateFrom({none, none, Value::of("Ready")}), State::ready);
}

TEST(ProgramState, TrustsTheIdMostAndTheNameLeast) {
    const auto number = Value::of(std::uint32_t{11});
    EXPECT_EQ(stateFrom({id(2402), number, text("Ready")}), State::running);
    EXPECT_EQ(stateFrom({id(7, 4), number, text("Ready")}), State::halted)
        << "a server's own state has an id of its own";
    EXPECT_EQ(stateFrom({id(2400, 4), Value(), text("Halted")}), State::halted)
        << "the same number in another namespace is another node";
}

TEST(ProgramState, IsNoneIfNothingNamesOne) {
    const Value none;
    EXPECT_EQ(stateFrom({none, none, none}), std::nullopt);
    EXPECT_EQ(stateFrom({id(2401), Value::of(std::uint32_t{10}), text("Idle")}), std::nullopt);
    EXPECT_EQ(stateFrom({text("Ready"), Value::of(-12), id(2400)}), std::nullopt)
        << "values of other types than they should be";
}

TEST(ProgramTransition, IsNamedByIdByNumberOrByName) {
    const Value none;
    EXPECT_EQ(transitionFrom({id(2408), none, none}), TransitionNumber::halted_to_ready);
    EXPECT_EQ(transitionFrom({id(2424), none, none}), TransitionNumber::ready_to_halted);
    EXPECT_EQ(transitionFrom({none, Value::of(std::uint32_t{4}), none}),
              TransitionNumber::running_to_ready);
    EXPECT_EQ(transitionFrom({none, none, text("SuspendedToReady")}),
              TransitionNumber::suspended_to_ready);
    for (const std::uint32_t other : {2406U, 2409U, 2426U}) {
        EXPECT_EQ(transitionFrom({id(other), none, none}), std::nullopt) << other;
    }
    for (const std::uint32_t other : {0U, 10U}) {
        EXPECT_EQ(transitionFrom({none, Value::of(other), none}), std::nullopt) << other;
    }
}

TEST(ProgramTransition, LiesBetweenTwoStates) {
    EXPECT_EQ(transitionBetween(State::ready, State::running), TransitionNumber::ready_to_running);
    EXPECT_EQ(transitionBetween(State::suspended, State::halted),
              TransitionNumber::suspended_to_halted);
    EXPECT_EQ(transitionBetween(State::halted, State::running), std::nullopt);
    EXPECT_EQ(transitionBetween(State::ready, State::ready), std::nullopt);
}

TEST(ProgramNow, IsReadFromWhatTheServerHas) {
    std::vector<opcua::DataValue> values(programItems({}).size());
    EXPECT_FALSE(programNow(values)) << "none of the nodes is there";
    values[0].value = id(2400);
    EXPECT_EQ(programNow(values)->state, State::ready);
    EXPECT_EQ(programNow(values)->last, std::nullopt);
    values[3].value = id(2422);
    EXPECT_EQ(programNow(values)->last, TransitionNumber::suspended_to_ready);
}

}  // namespace
}  // namespace metier::client
