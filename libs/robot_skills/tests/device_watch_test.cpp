#include "metier/robot_skills/device_watch.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "bench.hpp"

namespace metier::robot_skills {
namespace {

using skill::State;
using skill::SubState;

TEST(DeviceWatch, HaltsEveryProgramWhenTheControllerIsGone) {
    Bench bench;
    const DeviceWatch watch(bench.arm(), bench.sharedExecutor(),
                            {&bench.program(kJointPtp), &bench.program(kPositionStream)});
    bench.arm().disconnect();
    bench.step();
    for (const auto& name : {kJointPtp, kPositionStream}) {
        EXPECT_EQ(bench.program(name).state(), State::halted);
        EXPECT_EQ(bench.program(name).subState(), SubState::halted_device_lost);
        EXPECT_THAT(bench.program(name).reasonText(), ::testing::HasSubstr("no connection"));
    }
    bench.arm().reconnect();
    bench.step();
    EXPECT_TRUE(bench.program(kJointPtp).reset(bench.caller()));
}

TEST(DeviceWatch, HaltsWhatIsReadyInAProtectiveStopSoThatResetLeadsBack) {
    Bench bench;
    const DeviceWatch watch(bench.arm(), bench.sharedExecutor(), {&bench.program(kJointPtp)});
    bench.arm().protectiveStop("fence opened");
    bench.step();
    EXPECT_EQ(bench.program(kJointPtp).state(), State::halted);
    EXPECT_EQ(bench.program(kJointPtp).subState(), SubState::halted_error) << "it is not lost";
    EXPECT_THAT(bench.program(kJointPtp).reasonText(), ::testing::HasSubstr("fence opened"));
    bench.step();
    EXPECT_TRUE(bench.program(kJointPtp).reset(bench.caller()));
    EXPECT_EQ(bench.program(kJointPtp).state(), State::ready);
}

TEST(DeviceWatch, LeavesAStopDuringAMotionToTheMotion) {
    Bench bench;
    const DeviceWatch watch(bench.arm(), bench.sharedExecutor(),
                            {&bench.program(kJointPtp), &bench.program(kPositionStream)});
    ASSERT_TRUE(bench.program(kPositionStream).start(bench.caller()));
    bench.step();
    bench.arm().protectiveStop("fence opened");
    bench.step();
    bench.step();
    EXPECT_EQ(bench.program(kPositionStream).state(), State::halted);
    EXPECT_EQ(bench.program(kPositionStream).subState(), SubState::halted_error);
}

TEST(DeviceWatch, HaltsAtOnceIfTheControllerIsInAStopAlready) {
    Bench bench;
    bench.arm().protectiveStop("fence opened");
    bench.step();
    const DeviceWatch watch(bench.arm(), bench.sharedExecutor(), {&bench.program(kJointPtp)});
    EXPECT_EQ(bench.program(kJointPtp).state(), State::halted);
}

TEST(DeviceWatch, TellsNobodyOnceItIsGone) {
    Bench bench;
    {
        const DeviceWatch watch(bench.arm(), bench.sharedExecutor(), {&bench.program(kJointPtp)});
        bench.arm().disconnect();
        bench.arm().step();
    }
    bench.step();
    EXPECT_EQ(bench.program(kJointPtp).state(), State::ready);
}

}  // namespace
}  // namespace metier::robot_skills
