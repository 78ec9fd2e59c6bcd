#include "metrics/program_meter.hpp"

#include <gtest/gtest.h>

#include <numeric>

#include "metier/skill/lambda_skill.hpp"
#include "metier/skill/testing/manual_executor.hpp"
#include "metier/skill/testing/manual_work.hpp"

namespace metier::server {
namespace {

using skill::Method;
using skill::Reason;
using skill::State;

const skill::Caller kAlice{"alice", "client", "alice"};

/// A Program whose work ends when the test says so.
struct MeteredProgram : testing::Test {
    static skill::SkillDescription description() {
        skill::SkillDescription description;
        description.name = "WeldSkill";
        description.type = "WeldSkillType";
        return description;
    }
    std::uint64_t durations() const {
        const auto counts = meter.durations().read().counts;
        return std::accumulate(counts.begin(), counts.end(), std::uint64_t{0});
    }

    std::shared_ptr<skill::testing::ManualExecutor> executor =
        std::make_shared<skill::testing::ManualExecutor>();
    skill::ExecutionHandle execution;
    skill::Program program{
        {},
        std::make_unique<skill::LambdaSkill>(description(), skill::testing::manualWork(execution)),
        executor,
        executor->clock()};
    ProgramMeter meter{program};
};

TEST_F(MeteredProgram, CountsWhatFinished) {
    ASSERT_TRUE(program.start(kAlice));
    EXPECT_EQ(meter.state(), State::running);
    EXPECT_EQ(meter.starts(), 1U);
    execution.finish();
    executor->run();
    EXPECT_EQ(meter.state(), State::ready);
    EXPECT_EQ(meter.finished(), 1U);
    EXPECT_EQ(durations(), 1U);
}

TEST_F(MeteredProgram, CountsHaltsByTheirReason) {
    ASSERT_TRUE(program.start(kAlice));
    ASSERT_TRUE(program.halt(kAlice));
    executor->run();
    ASSERT_TRUE(program.reset(kAlice));
    ASSERT_TRUE(program.start(kAlice));
    execution.fail(Reason::force_exceeded, "12 N over 10 N");
    executor->run();
    EXPECT_EQ(meter.state(), State::halted);
    EXPECT_EQ(meter.halts(Reason::by_client), 1U);
    EXPECT_EQ(meter.halts(Reason::force_exceeded), 1U);
    EXPECT_EQ(meter.finished(), 0U);
    EXPECT_EQ(durations(), 2U);
}

TEST_F(MeteredProgram, CountsASuspendedExecutionOnce) {
    ASSERT_TRUE(program.start(kAlice));
    ASSERT_TRUE(program.suspend(kAlice));
    executor->run();
    EXPECT_EQ(meter.state(), State::suspended);
    ASSERT_TRUE(program.resume(kAlice));
    ASSERT_TRUE(program.suspend(kAlice));
    executor->run();
    ASSERT_TRUE(program.reset(kAlice));
    EXPECT_EQ(meter.starts(), 1U);
    EXPECT_EQ(meter.suspends(), 2U);
    EXPECT_EQ(durations(), 1U);
}

TEST_F(MeteredProgram, CountsWhatItRefuses) {
    EXPECT_FALSE(program.resume(kAlice));
    EXPECT_FALSE(program.startWith(kAlice, {.parameters = {{"Nothing", 1.0}}}));
    EXPECT_FALSE(program.startWith(kAlice, {.parameters = {{"Nothing", 1.0}}}));
    EXPECT_EQ(meter.refusals(Method::resume), 1U);
    EXPECT_EQ(meter.refusals(Method::start_with), 2U);
    EXPECT_EQ(meter.refusals(Method::start), 0U);
    EXPECT_EQ(meter.starts(), 0U);
}

TEST_F(MeteredProgram, ThatIsHaltedWhileReadyEndsNothing) {
    ASSERT_TRUE(program.halt(kAlice));
    EXPECT_EQ(meter.state(), State::halted);
    EXPECT_EQ(meter.halts(Reason::by_client), 0U);
    EXPECT_EQ(durations(), 0U);
}

}  // namespace
}  // namespace metier::server
