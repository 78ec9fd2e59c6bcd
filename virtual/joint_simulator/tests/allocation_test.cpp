#include <gtest/gtest.h>

#include <memory>

#include "metier/base/testing/allocation_count.hpp"
#include "metier/joint_simulator/joint_simulator.hpp"
#include "simulated_arm.hpp"

namespace metier::joint_simulator {
namespace {

std::size_t allocationsOf(JointSimulator& arm, int cycles) {
    const auto before = allocationCount();
    for (int i = 1; i <= cycles; ++i) {
        arm.cycle(SteadyTime(arm.info().cycle * i), 0);
    }
    return allocationCount() - before;
}

TEST(JointSimulatorCycle, DoesNotAllocate) {
    auto arm = twoAxisArm();
    auto source = cruise(0.5);
    ASSERT_TRUE(arm->attach(source));
    EXPECT_EQ(allocationsOf(*arm, 100), 0U);
}

TEST(JointSimulatorCycle, DoesNotAllocateWhenItStopsItself) {
    auto arm = twoAxisArm();
    auto source = cruise(2.0);
    ASSERT_TRUE(arm->attach(source));
    EXPECT_EQ(allocationsOf(*arm, 100), 0U);
    EXPECT_EQ(arm->state().safety, device::SafetyState::protective_stop);
}

TEST(JointSimulatorCycle, IsWatchedByACounterThatWorks) {
    const auto before = allocationCount();
    const auto something = std::make_unique<int>(1);
    EXPECT_EQ(allocationCount() - before, 1U);
    EXPECT_EQ(*something, 1);
}

}  // namespace
}  // namespace metier::joint_simulator
