// Functions that the cycle thread calls must not allocate: operator new is counted here.

#include <gtest/gtest.h>

#include <memory>

#include "metier/base/testing/allocation_count.hpp"
#include "metier/motion/force_limit.hpp"
#include "metier/motion/motion_run.hpp"
#include "metier/motion/planner.hpp"
#include "metier/motion/stream_follower.hpp"
#include "test_robots.hpp"

namespace metier::motion {
namespace {

using AllocationOf = EachRobot;
INSTANTIATE_TEST_SUITE_P(Robots, AllocationOf, testing::ValuesIn(kRobots), robotName);

TEST_P(AllocationOf, ASampledMotionDoesNotAllocate) {
    LinRequest request;
    request.start = model_.home();
    request.reference = TargetReference::relative_base;
    request.target.translation = {0, 0, 0.1};
    MotionRun execution(Planner(model_).lin(request).value());
    const std::size_t before = allocationCount();
    for (int i = 0; i < 2000; ++i) {
        if (i == 100) {
            execution.setOverride(0.5);
        } else if (i == 200) {
            execution.stop();
        } else if (i == 500) {
            execution.resume();
        } else if (i == 600) {
            execution.halt();
        }
        execution.next(Seconds(0.001));
        EXPECT_GE(execution.stoppingEstimate().time.count(), 0.0);
    }
    EXPECT_EQ(allocationCount() - before, 0U);
}

TEST(Allocation, AForceCheckDoesNotAllocate) {
    ForceLimit limit = ForceLimit::create({50, 5, {0, 0, 40, 0, 0, 0}}, Seconds(0.002)).value();
    const std::size_t before = allocationCount();
    int beyond = 0;
    for (int i = 0; i < 500; ++i) {
        beyond += limit.check({{0, 0, 0.2 * i}, {0, 0, 0}}) ? 1 : 0;
    }
    EXPECT_GT(beyond, 0);
    EXPECT_EQ(allocationCount() - before, 0U);
}

TEST_P(AllocationOf, AFollowedStreamDoesNotAllocate) {
    for (const int delay : {0, 3}) {
        StreamFollower follower =
            StreamFollower::create(model_, {Seconds(model_.cycleTime()), delay}, model_.home())
                .value();
        const std::size_t before = allocationCount();
        for (int i = 0; i < 500; ++i) {
            JointVector q = model_.home();
            q[0] += i % 2 == 0 ? 1e-4 : 0.0;
            const Seconds now = i * Seconds(model_.cycleTime());
            if (i % 10 < 8) {
                follower.accept(q, now, now);
            }
            follower.accept(JointVector(3), now, now);
            follower.next(now);
        }
        EXPECT_EQ(allocationCount() - before, 0U);
    }
}

TEST_P(AllocationOf, KinematicsThatSucceedDoNotAllocate) {
    const motion::Pose pose = kinematics_.forward(model_.home());
    const IkRequest request{model_.home(), {}, {}};
    const std::size_t before = allocationCount();
    for (int i = 0; i < 10; ++i) {
        EXPECT_TRUE(kinematics_.inverse(pose, request));
        EXPECT_TRUE(kinematics_.solveNumerically(pose, model_.home(), 10));
    }
    EXPECT_EQ(allocationCount() - before, 0U);
}

TEST(Allocation, IsCounted) {
    const std::size_t before = allocationCount();
    const auto value = std::make_unique<JointVector>(6);
    EXPECT_EQ(allocationCount() - before, 1U);
}

}  // namespace
}  // namespace metier::motion
