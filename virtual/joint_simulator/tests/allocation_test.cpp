#include <gtest/gtest.h>

#include <atomic>
#include <cstdlib>
#include <new>

#include "metier/joint_simulator/joint_simulator.hpp"
#include "simulated_arm.hpp"

namespace {

// Of this thread alone, so that the test's other threads do not count.
thread_local std::size_t allocations = 0;

}  // namespace

[[gnu::noinline]] void* operator new(std::size_t size) {
    ++allocations;
    if (void* memory = std::malloc(size)) {  // NOLINT(cppcoreguidelines-no-malloc): is operator new
        return memory;
    }
    throw std::bad_alloc();
}

[[gnu::noinline]] void operator delete(void* memory) noexcept {
    std::free(memory);  // NOLINT(cppcoreguidelines-no-malloc): is operator delete
}

[[gnu::noinline]] void operator delete(void* memory, std::size_t) noexcept {
    std::free(memory);  // NOLINT(cppcoreguidelines-no-malloc): is operator delete
}

namespace metier::virtual_robots {
namespace {

std::size_t allocationsOf(JointSimulator& arm, int cycles) {
    const auto before = allocations;
    for (int i = 1; i <= cycles; ++i) {
        arm.cycle(SteadyTime(arm.info().cycle * i), 0);
    }
    return allocations - before;
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
    const auto before = allocations;
    const auto something = std::make_unique<int>(1);
    EXPECT_EQ(allocations - before, 1U);
    EXPECT_EQ(*something, 1);
}

}  // namespace
}  // namespace metier::virtual_robots
