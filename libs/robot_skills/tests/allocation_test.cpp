#include <gtest/gtest.h>

#include "bench.hpp"
#include "metier/base/testing/allocation_count.hpp"

namespace metier::robot_skills {
namespace {

using skill::Frame;
using skill::State;

/// Allocations of so many cycles of the arm alone, without what follows on other threads.
std::size_t allocationsOf(Bench& bench, int cycles) {
    auto& arm = bench.arm();
    const auto before = allocationCount();
    for (int i = 0; i < cycles; ++i) {
        arm.cycle(SteadyTime(arm.info().cycle * i), 0);
    }
    return allocationCount() - before;
}

TEST(MoveCycle, DoesNotAllocateOnALineToItsEnd) {
    Bench bench("iiwa7");
    ASSERT_TRUE(bench.start(
        kCartesianLinear, {{"TargetPosition", Frame{0, 0, -0.1}}, {"Relative", std::int32_t{1}}}));
    EXPECT_EQ(allocationsOf(bench, 3000), 0U);
    bench.step();
    EXPECT_EQ(bench.program(kCartesianLinear).state(), State::ready);
}

TEST(MoveCycle, DoesNotAllocateOnPtpAndHalt) {
    Bench bench;
    ASSERT_TRUE(bench.start(kJointPtp, {{"TargetJointPosition", std::vector<double>(6, 0.5)},
                                        {"Relative", std::int32_t{1}}}));
    EXPECT_EQ(allocationsOf(bench, 40), 0U);
    ASSERT_TRUE(bench.program(kJointPtp).halt(bench.caller()));
    EXPECT_EQ(allocationsOf(bench, 200), 0U);
    bench.step();
    EXPECT_EQ(bench.program(kJointPtp).state(), State::halted);
}

class StreamCycle : public ::testing::TestWithParam<double> {};
INSTANTIATE_TEST_SUITE_P(Delays, StreamCycle, ::testing::Values(0.0, 0.024));

TEST_P(StreamCycle, DoesNotAllocate) {
    Bench bench;
    ASSERT_TRUE(bench.start(kPositionStream, {{"PlayOutDelay", GetParam()}}));
    const auto joints = bench.commanded();
    for (int i = 0; i < 100; ++i) {
        std::vector<double> target(joints.begin(), joints.end());
        target[0] += 1e-4 * i;
        ASSERT_TRUE(
            bench.program(kPositionStream).write(bench.caller(), "TargetJointPosition", target));
        ASSERT_EQ(allocationsOf(bench, 1), 0U);
        bench.executor().advance(bench.arm().info().cycle);
    }
    EXPECT_EQ(allocationsOf(bench, 100), 0U) << "when it falls silent and brakes";
}

}  // namespace
}  // namespace metier::robot_skills
