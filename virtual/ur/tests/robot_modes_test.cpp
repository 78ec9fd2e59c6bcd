#include "robot_modes.hpp"

#include <gmock/gmock.h>

namespace metier::virtual_ur {
namespace {

using testing::HasSubstr;

constexpr ModeTimes kTimes{1.0, 0.5, 5.0};

void pass(RobotModes& modes, double seconds, bool standing = true) {
    for (double time = 0.0; time < seconds - 1e-9; time += 0.1) {
        modes.step(0.1, standing);
    }
}

TEST(RobotModes, PowerOnAndBrakeReleaseLeadToRunning) {
    RobotModes modes(kTimes, PowerAtStart::off);
    EXPECT_EQ(modes.robotMode(), RobotMode::power_off);
    ASSERT_TRUE(modes.powerOn());
    EXPECT_EQ(modes.robotMode(), RobotMode::booting);
    pass(modes, 0.6);
    EXPECT_EQ(modes.robotMode(), RobotMode::power_on);
    pass(modes, 0.6);
    EXPECT_EQ(modes.robotMode(), RobotMode::idle);
    pass(modes, 2.0);
    EXPECT_EQ(modes.robotMode(), RobotMode::idle);
    ASSERT_TRUE(modes.releaseBrakes());
    EXPECT_EQ(modes.robotMode(), RobotMode::idle);
    pass(modes, 0.6);
    EXPECT_EQ(modes.robotMode(), RobotMode::running);
    EXPECT_TRUE(modes.mayRun());
}

TEST(RobotModes, BrakeReleasePowersOnByItself) {
    RobotModes modes(kTimes, PowerAtStart::off);
    ASSERT_TRUE(modes.releaseBrakes());
    pass(modes, 2.0);
    EXPECT_EQ(modes.robotMode(), RobotMode::running);
}

TEST(RobotModes, PowerGoesOffOnlyWhenTheArmStands) {
    RobotModes modes(kTimes, PowerAtStart::running);
    modes.powerOff();
    pass(modes, 1.0, false);
    EXPECT_EQ(modes.robotMode(), RobotMode::running);
    pass(modes, 0.1);
    EXPECT_EQ(modes.robotMode(), RobotMode::power_off);
    EXPECT_EQ(modes.jointMode(), JointMode::power_off);
}

TEST(RobotModes, AProtectiveStopCannotBeUnlockedAtOnce) {
    RobotModes modes(kTimes, PowerAtStart::running);
    EXPECT_EQ(modes.safetyStatusBits(), 1U);
    modes.protectiveStop();
    EXPECT_EQ(modes.safetyMode(), SafetyMode::protective_stop);
    EXPECT_EQ(modes.robotMode(), RobotMode::running);
    EXPECT_EQ(modes.safetyStatusBits(), 1U << 2U | 1U << 10U);
    EXPECT_FALSE(modes.mayRun());
    pass(modes, 4.8);
    const auto refused = modes.unlock();
    ASSERT_FALSE(refused);
    EXPECT_THAT(refused.error().message, HasSubstr("5s"));
    pass(modes, 0.3);
    EXPECT_TRUE(modes.unlock());
    EXPECT_TRUE(modes.mayRun());
    EXPECT_FALSE(modes.unlock());
}

TEST(RobotModes, AnEmergencyStopTakesThePowerAndHasToBeReleasedFirst) {
    RobotModes modes(kTimes, PowerAtStart::running);
    modes.emergencyStop();
    EXPECT_EQ(modes.safetyMode(), SafetyMode::robot_emergency_stop);
    EXPECT_EQ(modes.safetyStatusBits(), 1U << 6U | 1U << 7U | 1U << 10U);
    pass(modes, 0.1);
    EXPECT_EQ(modes.robotMode(), RobotMode::power_off);
    EXPECT_FALSE(modes.powerOn());
    EXPECT_FALSE(modes.unlock());
    modes.restartSafety();
    EXPECT_TRUE(modes.emergencyStopped());
    modes.releaseEmergencyStop();
    EXPECT_EQ(modes.safetyMode(), SafetyMode::normal);
    EXPECT_EQ(modes.robotMode(), RobotMode::power_off);
    EXPECT_TRUE(modes.releaseBrakes());
    pass(modes, 2.0);
    EXPECT_TRUE(modes.mayRun());
}

TEST(RobotModes, AnOpenSafeguardStopsUntilItIsClosed) {
    RobotModes modes(kTimes, PowerAtStart::running);
    modes.closeSafeguard();
    EXPECT_TRUE(modes.mayRun());
    modes.safeguardStop();
    EXPECT_EQ(modes.safetyMode(), SafetyMode::safeguard_stop);
    EXPECT_EQ(modes.safetyStatusBits(), 1U << 4U | 1U << 10U);
    pass(modes, 10.0);
    EXPECT_FALSE(modes.mayRun());
    EXPECT_FALSE(modes.unlock());
    EXPECT_EQ(modes.robotMode(), RobotMode::running) << "the power stays";
    modes.closeSafeguard();
    EXPECT_TRUE(modes.mayRun());
}

TEST(RobotModes, AViolationTakesThePowerUntilTheSafetySystemIsRestarted) {
    RobotModes modes(kTimes, PowerAtStart::running);
    modes.violation();
    pass(modes, 0.1);
    EXPECT_EQ(modes.safetyStatusBits(), 1U << 8U | 1U << 10U);
    EXPECT_EQ(modes.robotMode(), RobotMode::power_off);
    EXPECT_FALSE(modes.powerOn());
    modes.closeSafeguard();
    modes.releaseEmergencyStop();
    EXPECT_EQ(modes.safetyMode(), SafetyMode::violation);
    modes.restartSafety();
    EXPECT_TRUE(modes.releaseBrakes());
    pass(modes, 2.0);
    EXPECT_TRUE(modes.mayRun());
}

TEST(RobotModes, ARestartOfTheSafetySystemEndsAProtectiveStopWithoutPower) {
    RobotModes modes(kTimes, PowerAtStart::running);
    modes.protectiveStop();
    modes.restartSafety();
    pass(modes, 0.1);
    EXPECT_EQ(modes.safetyMode(), SafetyMode::normal);
    EXPECT_EQ(modes.robotMode(), RobotMode::power_off);
}

TEST(RobotModes, AnArmWithoutPowerHasNoProtectiveStop) {
    RobotModes modes(kTimes, PowerAtStart::off);
    modes.protectiveStop();
    EXPECT_EQ(modes.safetyMode(), SafetyMode::normal);
}

TEST(RobotModes, NamesAreTheDashboards) {
    EXPECT_EQ(toText(RobotMode::no_controller), "NO_CONTROLLER");
    EXPECT_EQ(toText(RobotMode::power_off), "POWER_OFF");
    EXPECT_EQ(toText(RobotMode::running), "RUNNING");
    EXPECT_EQ(toText(SafetyMode::normal), "NORMAL");
    EXPECT_EQ(toText(SafetyMode::robot_emergency_stop), "ROBOT_EMERGENCY_STOP");
    EXPECT_EQ(toText(SafetyMode::fault), "FAULT");
}

}  // namespace
}  // namespace metier::virtual_ur
