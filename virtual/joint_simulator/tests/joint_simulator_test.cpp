#include "metier/joint_simulator/joint_simulator.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "simulated_arm.hpp"

namespace metier::joint_simulator {
namespace {

using device::EndCause;
using device::SafetyState;
using ::testing::HasSubstr;

void steps(JointSimulator& arm, int count) {
    for (int i = 0; i < count; ++i) {
        arm.step();
    }
}

TEST(JointSimulator, StandsWhereItStarts) {
    auto options = twoAxisOptions();
    options.start_position = {0.5, -0.5};
    auto arm = twoAxisArm(options);
    steps(*arm, 3);
    const auto state = arm->state();
    EXPECT_EQ(state.position, joints(0.5, -0.5));
    EXPECT_EQ(state.commanded_position, joints(0.5, -0.5));
    EXPECT_EQ(state.safety, SafetyState::normal);
    EXPECT_TRUE(state.standstill);
    EXPECT_EQ(state.cycle, 3U);
    EXPECT_EQ(state.stamp, SteadyTime(std::chrono::milliseconds(30)));
}

TEST(JointSimulator, RefusesAStartOutsideItsLimits) {
    auto options = twoAxisOptions();
    options.start_position = {0.0, 2.5};
    const auto arm = JointSimulator::create(options);
    ASSERT_FALSE(arm);
    EXPECT_EQ(arm.error().code, Errc::invalid_argument);
    EXPECT_THAT(arm.error().message, HasSubstr("axis 2: start position 2.5 rad outside -2 to 2"));
}

TEST(JointSimulator, RefusesListsOfDifferentLengths) {
    auto options = twoAxisOptions();
    options.limits.pop_back();
    const auto arm = JointSimulator::create(options);
    ASSERT_FALSE(arm);
    EXPECT_THAT(arm.error().message, HasSubstr("2 axis names, 1 limits"));
}

TEST(JointSimulator, RefusesLimitsThatAreNone) {
    auto options = twoAxisOptions();
    options.limits[0].acceleration = 0.0;
    EXPECT_FALSE(JointSimulator::create(options));
    options = twoAxisOptions();
    options.cycle = std::chrono::nanoseconds(0);
    EXPECT_FALSE(JointSimulator::create(options));
}

TEST(JointSimulator, FollowsASourceWithItsLag) {
    auto arm = twoAxisArm();
    auto source = cruise(0.5);
    ASSERT_TRUE(arm->attach(source));
    steps(*arm, 50);
    const auto state = arm->state();
    EXPECT_NEAR(state.commanded_position[0] - state.position[0], 2 * 0.5 * 0.01, 1e-9);
    EXPECT_NEAR(state.velocity[0], 0.5, 1e-9);
    EXPECT_FALSE(state.standstill);
    EXPECT_THAT(source->ends(), ::testing::IsEmpty());
}

TEST(JointSimulator, HoldsTheLastSetPointOfASourceThatIsDone) {
    auto arm = twoAxisArm();
    auto source = std::make_shared<FunctionSource>([n = 0](const auto&) mutable {
        return ++n > 1 ? std::nullopt : std::optional(joints(0.0005, 0.0));
    });
    ASSERT_TRUE(arm->attach(source));
    steps(*arm, 2);
    ASSERT_EQ(source->ends().size(), 1U);
    EXPECT_EQ(source->ends()[0].first, EndCause::done);
    steps(*arm, 10);
    EXPECT_EQ(arm->state().position, joints(0.0005, 0.0));
    EXPECT_EQ(arm->state().safety, SafetyState::normal);
    EXPECT_EQ(source->ends().size(), 1U);
}

TEST(JointSimulator, LetsOneSourceAtATimeMoveIt) {
    auto arm = twoAxisArm();
    ASSERT_TRUE(arm->attach(cruise(0.1)));
    const auto second = arm->attach(cruise(0.1));
    ASSERT_FALSE(second);
    EXPECT_EQ(second.error().code, Errc::resource_unavailable);
}

TEST(JointSimulator, StopsItselfWhenASetPointBreaksALimit) {
    auto arm = twoAxisArm();
    auto source = cruise(2.0);
    ASSERT_TRUE(arm->attach(source));
    double last_speed = 0.0;
    double last = 0.0;
    for (int i = 0; i < 60; ++i) {
        arm->step();
        const double commanded = arm->state().commanded_position[0];
        const double speed = (commanded - last) / 0.01;
        EXPECT_LE(speed, 1.01 + 1e-9);
        EXPECT_LE(std::abs(speed - last_speed), 0.1 + 1e-9) << "brakes within its acceleration";
        last = commanded;
        last_speed = speed;
    }
    EXPECT_EQ(arm->state().safety, SafetyState::protective_stop);
    EXPECT_EQ(last_speed, 0.0);
    ASSERT_EQ(source->ends().size(), 1U);
    EXPECT_EQ(source->ends()[0].first, EndCause::safety);
    EXPECT_EQ(source->ends()[0].second.text,
              "arm: axis 1: velocity 1.1000 rad/s over limit 1.0000 rad/s");
}

TEST(JointSimulator, ReportsASafetyStopAtStandstillOnly) {
    auto arm = twoAxisArm();
    auto source = cruise(0.8);
    ASSERT_TRUE(arm->attach(source));
    steps(*arm, 30);
    arm->protectiveStop("fence opened");
    while (source->ends().empty()) {
        ASSERT_LT(arm->state().cycle, 100U);
        arm->step();
    }
    EXPECT_TRUE(arm->state().standstill);
    EXPECT_GE(arm->state().cycle, 38U) << "0.8 rad/s at 10 rad/s2 take 8 cycles";
    EXPECT_EQ(source->ends()[0].second.text, "arm: fence opened");
}

TEST(JointSimulator, RefusesASourceWhileStopped) {
    auto arm = twoAxisArm();
    arm->protectiveStop("fence opened");
    arm->step();
    const auto attached = arm->attach(cruise(0.1));
    ASSERT_FALSE(attached);
    EXPECT_EQ(attached.error().code, Errc::device_fault);
    EXPECT_EQ(attached.error().message, "arm: fence opened (protective stop)");
}

TEST(JointSimulator, MovesAgainAfterAReset) {
    auto arm = twoAxisArm();
    auto source = cruise(2.0);
    ASSERT_TRUE(arm->attach(source));
    steps(*arm, 60);
    ASSERT_TRUE(arm->resetFault());
    steps(*arm, 5);
    EXPECT_EQ(arm->state().safety, SafetyState::normal);
    EXPECT_EQ(arm->safety().text, "");
    const auto here = arm->state().commanded_position;
    EXPECT_TRUE(arm->attach(
        std::make_shared<FunctionSource>([here](const auto&) { return std::optional(here); })));
    steps(*arm, 5);
    EXPECT_EQ(arm->state().safety, SafetyState::normal);
}

TEST(JointSimulator, RefusesAResetWhileItBrakes) {
    auto arm = twoAxisArm();
    ASSERT_TRUE(arm->attach(cruise(0.8)));
    steps(*arm, 30);
    arm->protectiveStop("fence opened");
    arm->step();
    const auto reset = arm->resetFault();
    ASSERT_FALSE(reset);
    EXPECT_THAT(reset.error().message, HasSubstr("still brakes"));
}

TEST(JointSimulator, StaysInEmergencyStopUntilTheButtonIsReleased) {
    auto arm = twoAxisArm();
    arm->emergencyStop(EmergencyStop::pressed);
    steps(*arm, 2);
    EXPECT_EQ(arm->state().safety, SafetyState::emergency_stop);
    EXPECT_THAT(arm->resetFault().error().message, HasSubstr("still pressed"));
    arm->emergencyStop(EmergencyStop::released);
    arm->step();
    EXPECT_EQ(arm->state().safety, SafetyState::emergency_stop) << "releasing alone resets nothing";
    EXPECT_TRUE(arm->resetFault());
    arm->step();
    EXPECT_EQ(arm->state().safety, SafetyState::normal);
}

TEST(JointSimulator, TellsADisconnectionAtOnceAndBrakesAlone) {
    auto arm = twoAxisArm();
    auto source = cruise(0.8);
    ASSERT_TRUE(arm->attach(source));
    steps(*arm, 30);
    const auto before = arm->state();
    arm->disconnect();
    arm->step();
    ASSERT_EQ(source->ends().size(), 1U);
    EXPECT_EQ(source->ends()[0].first, EndCause::disconnected);
    EXPECT_EQ(arm->state().position, before.position) << "nothing newer is known";
    EXPECT_EQ(arm->resetFault().error().code, Errc::connection_lost);
    steps(*arm, 20);
    arm->reconnect();
    arm->step();
    EXPECT_EQ(arm->state().safety, SafetyState::normal);
    EXPECT_TRUE(arm->state().standstill);
    EXPECT_GT(arm->state().position[0], before.position[0]);
}

TEST(JointSimulator, StopsWithItsOwnBrakesOnRequest) {
    auto arm = twoAxisArm();
    auto source = cruise(0.8);
    ASSERT_TRUE(arm->attach(source));
    steps(*arm, 30);
    arm->stop();
    arm->step();
    EXPECT_THAT(source->ends(), ::testing::IsEmpty()) << "it still moves";
    steps(*arm, 15);
    ASSERT_EQ(source->ends().size(), 1U);
    EXPECT_EQ(source->ends()[0].first, EndCause::stopped);
    EXPECT_EQ(arm->state().safety, SafetyState::normal);
    EXPECT_TRUE(arm->attach(cruise(0.1)));
}

TEST(JointSimulator, IgnoresAStopWhenNothingMovesIt) {
    auto arm = twoAxisArm();
    arm->stop();
    auto source = cruise(0.1);
    ASSERT_TRUE(arm->attach(source));
    steps(*arm, 20);
    EXPECT_THAT(source->ends(), ::testing::IsEmpty());
}

TEST(JointSimulator, TellsEachChangeOfItsSafetyState) {
    auto arm = twoAxisArm();
    std::vector<SafetyState> seen;
    {
        const auto registration =
            arm->onSafetyChange([&](const auto& safety) { seen.push_back(safety.state); });
        steps(*arm, 2);
        arm->protectiveStop("fence opened");
        steps(*arm, 2);
        ASSERT_TRUE(arm->resetFault());
        steps(*arm, 2);
    }
    arm->disconnect();
    steps(*arm, 2);
    EXPECT_THAT(seen, ::testing::ElementsAre(SafetyState::protective_stop, SafetyState::normal));
}

TEST(JointSimulator, CanBePushedByHandOnlyWhileNobodyMovesIt) {
    auto arm = twoAxisArm();
    arm->moveByHand(joints(0.3, 0.4));
    arm->step();
    EXPECT_EQ(arm->state().position, joints(0.3, 0.4));
    EXPECT_EQ(arm->state().commanded_position, joints(0.3, 0.4));
    ASSERT_TRUE(arm->attach(std::make_shared<FunctionSource>(
        [](const auto&) { return std::optional(joints(0.3, 0.4)); })));
    arm->moveByHand(joints(0.0, 0.0));
    steps(*arm, 3);
    EXPECT_EQ(arm->state().position, joints(0.3, 0.4));
}

TEST(JointSimulator, TellsItsSourceWhenItIsShutDown) {
    auto source = cruise(0.1);
    {
        auto arm = twoAxisArm();
        ASSERT_TRUE(arm->attach(source));
    }
    ASSERT_EQ(source->ends().size(), 1U);
    EXPECT_EQ(source->ends()[0].first, EndCause::disconnected);
}

}  // namespace
}  // namespace metier::joint_simulator
