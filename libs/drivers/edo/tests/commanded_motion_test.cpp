#include "commanded_motion.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "machine_text.hpp"

namespace metier::edo_driver {
namespace {

using namespace std::chrono_literals;
using device::SafetyState;
using ::testing::HasSubstr;

device::JointArray both(double first, double second) {
    device::JointArray values(2);
    values[0] = first;
    values[1] = second;
    return values;
}

/// Two axes of +-1 rad, 0.4 rad/s, braking with 2 rad/s2.
const AxisOptions kAxes(2, {-1.0, 1.0, 0.4, 2.0, 0.0});
const SteadyTime kStart{1000s};

TEST(CommandedMotion, BrakesEachAxisOnItsOwn) {
    CommandedMotion motion(kAxes);
    for (int i = 1; i <= 10; ++i) {
        ASSERT_FALSE(motion.accept(both(0.004 * i, -0.001 * i)));  // 0.4 and -0.1 rad/s
    }
    int cycles = 0;
    while (!motion.standing() && cycles < 100) {
        motion.brake();
        ++cycles;
    }
    EXPECT_EQ(cycles, 20) << "0.4 rad/s by 0.02 rad/s per cycle";
    EXPECT_NEAR(motion.position()[0], 0.04 + 0.4 * 0.4 / 2 / 2, 0.003);
    EXPECT_NEAR(motion.position()[1], -0.01 - 0.1 * 0.1 / 2 / 2, 0.001);
}

TEST(CommandedMotion, RefusesWhatIsBeyondALimitAndStaysWhereItIs) {
    CommandedMotion motion(kAxes);
    motion.reset(both(0.999, 0));
    EXPECT_THAT(toText(*motion.accept(both(1.005, 0))),
                HasSubstr("axis 1: set-point 1.0050 rad beyond its limit 1.0000 rad"));
    EXPECT_THAT(toText(*motion.accept(device::JointArray(3))), HasSubstr("3 axes instead of 2"));
    EXPECT_EQ(motion.position(), both(0.999, 0));
    EXPECT_TRUE(motion.standing());
}

TEST(CommandedMotion, RefusesWhatIsBeyondALowerLimit) {
    CommandedMotion motion(kAxes);
    motion.reset(both(0, -0.999));
    EXPECT_THAT(toText(*motion.accept(both(0, -1.0045))),
                HasSubstr("axis 2: set-point -1.0045 rad beyond its limit -1.0000 rad"));
}

TEST(CommandedMotion, LeavesToTheRobotWhatItClampsByItself) {
    CommandedMotion motion(kAxes);
    motion.reset(both(1, -1));
    EXPECT_FALSE(motion.accept(both(1.0034, -1.0034)));
    EXPECT_TRUE(motion.accept(both(1.0036, -1.0034)));
    EXPECT_TRUE(motion.accept(both(1.0034, -1.0036)));
}

TEST(CommandedMotion, RefusesAStepOfMoreThanOneAndAHalfOfTheVelocity) {
    CommandedMotion motion(kAxes);
    EXPECT_FALSE(motion.accept(both(0.0059, -0.0059)));
    motion.reset(both(0, 0));
    EXPECT_THAT(toText(*motion.accept(both(0.0061, 0))),
                HasSubstr("axis 1: set-point at 0.6100 rad/s over its limit 0.4000 rad/s"));
    EXPECT_THAT(toText(*motion.accept(both(0, -0.0061))),
                HasSubstr("axis 2: set-point at -0.6100 rad/s over its limit 0.4000 rad/s"));
    EXPECT_EQ(motion.position(), both(0, 0));
}

TEST(CommandedMotion, TakesNoMeasurementForItsPlaceWhileItBrakes) {
    CommandedMotion motion(kAxes);
    ASSERT_FALSE(motion.accept(both(0.004, 0)));
    EXPECT_FALSE(motion.standing());
    motion.settle(both(0.0041, 0));
    EXPECT_EQ(motion.position(), both(0.0041, 0)) << "who settles does not move";
    EXPECT_TRUE(motion.standing());
}

TEST(CommandedMotion, LetsAnAxisStayBeyondItsLimit) {
    CommandedMotion motion(kAxes);
    motion.reset(both(1.1, -1.1));
    EXPECT_FALSE(motion.accept(both(1.1, -1.1)));
}

TEST(CommandedMotion, LetsAnAxisBackFromBeyondItsLimit) {
    CommandedMotion motion(kAxes);
    motion.reset(both(1.1, 0));
    EXPECT_FALSE(motion.accept(both(1.098, 0)));
    EXPECT_TRUE(motion.accept(both(1.1, 0)));
}

TEST(CommandedMotion, DoesNotFollowTheNoiseOfAMeasurement) {
    CommandedMotion motion(kAxes);
    motion.reset(both(0.5, 0));
    motion.settle(both(0.5005, 0));
    EXPECT_EQ(motion.position(), both(0.5, 0));
    motion.settle(both(0.51, 0));
    EXPECT_EQ(motion.position(), both(0.51, 0));
}

TEST(FollowingWatch, ToleratesALagOnlyForATime) {
    FollowingWatch watch({0.1, 300ms});
    EXPECT_FALSE(watch.check(both(0, 0.2), both(0, 0), kStart));
    EXPECT_FALSE(watch.check(both(0, 0.2), both(0, 0), kStart + 290ms));
    EXPECT_FALSE(watch.check(both(0, 0.2), both(0, 0.15), kStart + 295ms)) << "caught up";
    EXPECT_FALSE(watch.check(both(0, 0.2), both(0, 0), kStart + 300ms));
    const auto lag = watch.check(both(0, 0.2), both(0, 0), kStart + 600ms);
    ASSERT_TRUE(lag);
    EXPECT_EQ(lag->axis, 1U);
    EXPECT_DOUBLE_EQ(lag->distance, 0.2);
}

TEST(Pacer, GivesOneSetPointPerCycleOnTheAverage) {
    Pacer pacer(10ms);
    int sent = 0;
    for (int i = 0; i < 100; ++i) {  // a jitter of 4 ms drops none
        sent += pacer.due(kStart + 10ms * i + (i % 2 == 0 ? 4ms : 0ms)) ? 1 : 0;
    }
    EXPECT_EQ(sent, 100);
    sent = 0;
    for (int i = 0; i < 1000; ++i) {  // one per millisecond
        sent += pacer.due(kStart + 2s + 1ms * i) ? 1 : 0;
    }
    EXPECT_NEAR(sent, 100, 1);
}

TEST(MachineText, NamesStatesAndBits) {
    EXPECT_EQ(toText({MachineState::calibrated, 0}), "CALIBRATED");
    EXPECT_EQ(toText({MachineState::braked, 0x240}), "BRAKED (brake active, collision)");
    EXPECT_EQ(toText({MachineState::error, 0x5}), "ERROR (a joint does not answer, overcurrent)");
    EXPECT_EQ(toText({42, 1U << 31U}), "state 42 (bit 31)");
}

TEST(MachineText, JudgesStatesAndBits) {
    const auto judged = [](std::uint8_t state, std::uint32_t opcode) {
        return safetyOf({state, opcode}).state;
    };
    EXPECT_EQ(judged(MachineState::calibrated, 0), SafetyState::normal);
    EXPECT_EQ(judged(MachineState::move, 0), SafetyState::normal);
    EXPECT_EQ(judged(MachineState::calibrated, MachineState::fence), SafetyState::protective_stop);
    EXPECT_EQ(judged(MachineState::calibrated, MachineState::emergency_stop),
              SafetyState::emergency_stop);
    EXPECT_EQ(judged(MachineState::calibrated, MachineState::uncalibrated), SafetyState::fault);
    EXPECT_EQ(judged(MachineState::calibrated, MachineState::joint_absent), SafetyState::fault);
    EXPECT_EQ(judged(MachineState::braked, MachineState::emergency_stop),
              SafetyState::emergency_stop);
    EXPECT_EQ(judged(MachineState::braked, 0), SafetyState::protective_stop);
    EXPECT_EQ(judged(MachineState::error, 0), SafetyState::fault);
    EXPECT_EQ(judged(MachineState::not_calibrated, 0), SafetyState::fault);
    EXPECT_EQ(judged(MachineState::brakes_check, 0), SafetyState::protective_stop);
    EXPECT_EQ(judged(MachineState::command, 0), SafetyState::protective_stop);
    EXPECT_EQ(judged(42, 0), SafetyState::protective_stop);
}

}  // namespace
}  // namespace metier::edo_driver
