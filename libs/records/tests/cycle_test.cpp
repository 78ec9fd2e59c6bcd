#include <gtest/gtest.h>

#include "bench.hpp"
#include "metier/base/testing/allocation_count.hpp"
#include "metier/records/program_recorder.hpp"
#include "recording_bench.hpp"

namespace metier::records {
namespace {

using robot_skills::Bench;
using skill::Frame;
using skill::State;

/// A skill on a simulated arm whose every cycle is the test's, while another thread records it.
TEST(RecordedCycle, DoesNotAllocateFromTheFirstToTheLast) {
    testing::RecordedFile file;
    Bench bench("iiwa7");
    PathSampler sampler(bench.arm(), nullptr, file.recorder());
    ProgramRecorder recorder(bench.program(robot_skills::kCartesianLinear), file.recorder(),
                             &sampler, {});
    ASSERT_TRUE(bench.start(robot_skills::kCartesianLinear, {{"TargetPosition", Frame{0, 0, -0.1}},
                                                             {"Relative", std::int32_t{1}}}));
    auto& arm = bench.arm();
    const auto before = allocationCount();
    for (int i = 0; i < 3000; ++i) {
        arm.cycle(SteadyTime(arm.info().cycle * i), 0);
        arm.measure(std::chrono::microseconds(i));
    }
    EXPECT_EQ(allocationCount() - before, 0U);
    bench.step();
    EXPECT_EQ(bench.program(robot_skills::kCartesianLinear).state(), State::ready);
    const auto store = file.store();
    const auto listed = store->list({}, {});
    ASSERT_TRUE(listed);
    ASSERT_EQ(listed->executions.size(), 1U);
    const auto path = store->path(listed->executions.front().number);
    ASSERT_TRUE(path);
    ASSERT_GE(path->size(), 2U);
    const auto end = arm.state().position;
    for (std::size_t axis = 0; axis < end.size(); ++axis) {
        EXPECT_NEAR(path->back().actual[axis], end[axis], 1e-3);
    }
}

}  // namespace
}  // namespace metier::records
