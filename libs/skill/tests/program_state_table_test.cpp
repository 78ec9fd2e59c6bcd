#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include "program_bench.hpp"

namespace metier::skill::testing {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr std::array kStates{State::halted, State::ready, State::running, State::suspended};
constexpr std::array kMethods{Method::start, Method::suspend, Method::resume, Method::halt,
                              Method::reset};

/// Model section 2: where a method leads from a state; nothing where it is not allowed.
std::optional<State> expectedState(State state, Method method) {
    if (state == State::ready && method == Method::start) {
        return State::running;
    }
    if (state == State::running && method == Method::suspend) {
        return State::suspended;
    }
    if (state == State::suspended && method == Method::resume) {
        return State::running;
    }
    if (state != State::halted && method == Method::halt) {
        return State::halted;
    }
    if ((state == State::halted || state == State::suspended) && method == Method::reset) {
        return State::ready;
    }
    return std::nullopt;
}

enum class Verdict { allowed, refused };
using Pair = std::tuple<State, Method>;

/// Those of the 20 pairs that are allowed, or those that are not.
std::vector<Pair> pairs(Verdict verdict) {
    std::vector<Pair> chosen;
    for (const auto state : kStates) {
        for (const auto method : kMethods) {
            if (expectedState(state, method).has_value() == (verdict == Verdict::allowed)) {
                chosen.emplace_back(state, method);
            }
        }
    }
    return chosen;
}

std::string nameOf(const ::testing::TestParamInfo<Pair>& info) {
    return std::string(toString(std::get<1>(info.param))) + "While" +
           std::string(toString(std::get<0>(info.param)));
}

class StateTable : public ::testing::TestWithParam<Pair> {
protected:
    StateTable() { bench_.enter(state_); }

    const State state_ = std::get<0>(GetParam());
    const Method method_ = std::get<1>(GetParam());
    ProgramBench bench_;
};

class AllowedMethod : public StateTable {};
class RefusedMethod : public StateTable {};

TEST_P(AllowedMethod, LeadsWhereTheModelSaysWithOneEvent) {
    const auto expected = *expectedState(state_, method_);
    ASSERT_EQ(bench_.program->state(), state_);
    EXPECT_TRUE(bench_.program->executable(method_, kAlice));
    ASSERT_TRUE(bench_.call(method_));
    bench_.script->execution.atRest();
    bench_.run();
    EXPECT_EQ(bench_.program->state(), expected);
    ASSERT_EQ(bench_.observer.events.size(), 1U);
    EXPECT_EQ(bench_.observer.events[0].from, state_);
    EXPECT_EQ(bench_.observer.events[0].to, expected);
    EXPECT_EQ(bench_.observer.events[0].reason, Reason::by_client);
}

TEST_P(RefusedMethod, ChangesNothingAndNamesMethodAndState) {
    ASSERT_EQ(bench_.program->state(), state_);
    const auto sub_state = bench_.program->subState();
    const auto reason = bench_.program->reason();
    EXPECT_FALSE(bench_.program->executable(method_, kAlice));
    const auto refused = bench_.call(method_);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, Errc::invalid_state);
    EXPECT_THAT(refused.error().message, HasSubstr(std::string(toString(method_))));
    EXPECT_THAT(refused.error().message, HasSubstr(std::string(toString(state_))));
    EXPECT_EQ(bench_.program->state(), state_);
    EXPECT_EQ(bench_.program->subState(), sub_state);
    EXPECT_EQ(bench_.program->reason(), reason);
    EXPECT_THAT(bench_.script->calls, IsEmpty());
    EXPECT_THAT(bench_.observer.log, ElementsAre("diagnostic " + std::string(toString(method_))));
}

INSTANTIATE_TEST_SUITE_P(EveryPair, AllowedMethod, ::testing::ValuesIn(pairs(Verdict::allowed)),
                         nameOf);
INSTANTIATE_TEST_SUITE_P(EveryPair, RefusedMethod, ::testing::ValuesIn(pairs(Verdict::refused)),
                         nameOf);

TEST(StateTablePairs, AreTwentyOfWhichEightAreAllowed) {
    EXPECT_EQ(pairs(Verdict::allowed).size(), 8U);
    EXPECT_EQ(pairs(Verdict::refused).size(), 12U);
}

TEST(Program, WhileStoppingAllowsOnlyHalt) {
    ProgramBench bench;
    bench.enter(State::running);
    ASSERT_TRUE(bench.program->suspend(kAlice));
    ASSERT_EQ(bench.program->subState(), SubState::stopping);
    for (const auto method : {Method::start, Method::suspend, Method::resume, Method::reset}) {
        EXPECT_FALSE(bench.program->executable(method, kAlice)) << toString(method);
        const auto refused = bench.call(method);
        ASSERT_FALSE(refused) << toString(method);
        EXPECT_EQ(refused.error().code, Errc::invalid_state);
        EXPECT_THAT(refused.error().message, HasSubstr("Stopping"));
    }
    EXPECT_TRUE(bench.program->executable(Method::halt, kAlice));
    EXPECT_TRUE(bench.program->halt(kAlice));
}

TEST(Program, BeginsReadyAndNotConfigured) {
    const ProgramBench bench;
    EXPECT_EQ(bench.program->state(), State::ready);
    EXPECT_EQ(bench.program->subState(), SubState::ready_not_configured);
    EXPECT_EQ(bench.program->reason(), Reason::none);
    EXPECT_FALSE(bench.program->lastTransition());
}

}  // namespace
}  // namespace metier::skill::testing
