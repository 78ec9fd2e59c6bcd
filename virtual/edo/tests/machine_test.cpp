#include "machine.hpp"

#include <gmock/gmock.h>

#include "rig.hpp"

namespace metier::virtual_edo {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

constexpr unsigned kUncalibrated = 1U << 3;
constexpr unsigned kAbsent = 1U << 1;
constexpr unsigned kOvercurrent = 1U << 2;
constexpr unsigned kNoAcknowledgement = 1U << 0;
constexpr unsigned kEmergencyStop = 1U << 7;

void init(Rig& rig, unsigned mask = 127) {
    rig.client.publish("/bridge_init",
                       {{"mode", 0}, {"joints_mask", mask}, {"reduction_factor", 0.0}});
}

void reset(Rig& rig, unsigned mask = 127) {
    rig.client.publish(
        "/bridge_jnt_reset",
        {{"joints_mask", mask}, {"disengage_steps", 2000}, {"disengage_offset", 3.5}});
}

void calibrate(Rig& rig, unsigned mask = 127) {
    rig.client.publish("/bridge_jnt_calib", {{"joints_mask", mask}});
}

TEST(Machine, StartsUpAsPyedoAsksItTo) {
    Rig rig({.ready = false});
    rig.run(20);
    EXPECT_EQ(rig.state(), 0);
    EXPECT_THAT(rig.client.last("/usb_jnt_state")["joints"], IsEmpty());

    init(rig);
    EXPECT_EQ(rig.state(), 255);
    const auto init_time = rig.runUntilState(6);
    ASSERT_TRUE(init_time);
    EXPECT_NEAR(*init_time, 1.1, 0.1);
    EXPECT_EQ(rig.opcode() & kUncalibrated, kUncalibrated);

    reset(rig);
    const auto reset_time = rig.runUntilState(1);
    ASSERT_TRUE(reset_time);
    EXPECT_NEAR(*reset_time, 0.55, 0.1);

    calibrate(rig);
    const auto calibration_time = rig.runUntilState(2);
    ASSERT_TRUE(calibration_time);
    EXPECT_NEAR(*calibration_time, 0.55, 0.1);
    rig.run(2);
    EXPECT_EQ(rig.opcode(), 0U);
    EXPECT_THAT(rig.states, ElementsAre(0, 255, 1, 6, 255, 1, 255, 1, 2));
}

TEST(Machine, PublishesItsStateTenTimesASecond) {
    Rig rig;
    rig.runSeconds(2.0);
    EXPECT_EQ(rig.client.messages("/machine_state").size(), 20U);
    EXPECT_EQ(rig.client.messages("/usb_jnt_state").size(), 200U);
    EXPECT_EQ(rig.client.messages("/algorithm_state").size(), 200U);
    EXPECT_EQ(rig.client.messages("/cartesian_pose").size(), 20U);
    EXPECT_EQ(rig.client.last("/machine_state")["current_state"], 2);
}

TEST(Machine, RaisesAndDropsTheAcknowledgementOfTheJoints) {
    Rig rig;
    rig.inject("brake");
    rig.runSeconds(0.5);
    rig.client.received.clear();
    reset(rig);
    rig.runUntilState(2);
    int raised = 0;
    for (const auto& state : rig.client.messages("/usb_jnt_state")) {
        raised += (state["joints"][0]["commandFlag"].get<int>() & 0xF) == 4 ? 1 : 0;
    }
    EXPECT_EQ(raised, 30);  // 300 ms
}

TEST(Machine, GoesBackToCalibratedByItselfAfterAReset) {
    Rig rig;
    rig.inject("brake");
    rig.run(5);
    EXPECT_EQ(rig.state(), 6);
    reset(rig);
    EXPECT_TRUE(rig.runUntilState(2));
    EXPECT_THAT(rig.states, testing::Contains(255));
}

TEST(Machine, StaysInInitForAMaskWithoutConfiguration) {
    Rig rig({.ready = false});
    init(rig, 15);
    EXPECT_EQ(rig.state(), 255);
    rig.runSeconds(9.9);
    EXPECT_EQ(rig.state(), 255);
    rig.runSeconds(0.2);
    EXPECT_EQ(rig.state(), 0);
}

TEST(Machine, ReportsAnErrorIfAJointDoesNotAcknowledgeInTenSeconds) {
    Rig rig;
    rig.inject("brake");
    rig.run(5);
    rig.inject("joint-silent", "3");
    reset(rig);
    rig.runSeconds(9.9);
    EXPECT_EQ(rig.state(), 255);
    rig.runSeconds(0.2);
    EXPECT_EQ(rig.state(), 5);
    EXPECT_EQ(rig.opcode() & kNoAcknowledgement, kNoAcknowledgement);
}

TEST(Machine, NotesASilentJointAfterTwentyReports) {
    Rig rig;
    rig.run(1);
    rig.inject("joint-silent", "2");
    rig.run(19);
    EXPECT_EQ(rig.opcode(), 0U);
    rig.run(1);
    EXPECT_EQ(rig.opcode(), kAbsent);
    EXPECT_EQ(rig.client.last("/usb_jnt_state")["joints_mask"], 127 - 2);
    rig.inject("joint-silent", "0");
    rig.run(1);
    EXPECT_EQ(rig.opcode(), 0U);
}

TEST(Machine, EndsInErrorWhenTheBusIsSilentForThreeSeconds) {
    Rig rig;
    rig.run(1);
    rig.inject("joint-silent", "all");
    rig.runSeconds(2.9);
    EXPECT_EQ(rig.state(), 2);
    rig.runSeconds(0.2);
    EXPECT_EQ(rig.state(), 5);
    EXPECT_EQ(rig.opcode(), kAbsent);
}

TEST(Machine, EndsInErrorByOvercurrentAndLeavesItByNothing) {
    Rig rig;
    rig.inject("overcurrent", "4");
    rig.run(2);
    EXPECT_EQ(rig.state(), 5);
    EXPECT_EQ(rig.opcode() & kOvercurrent, kOvercurrent);
    reset(rig);
    init(rig);
    calibrate(rig);
    rig.moveJoints({1, 1, 1, 1, 1, 1});
    rig.runSeconds(2);
    EXPECT_EQ(rig.state(), 5);
    EXPECT_THAT(rig.feedback(), IsEmpty());
}

TEST(Machine, BrakesByACollisionExceptForElevenSecondsAfterAReset) {
    Rig rig;
    rig.inject("collision");
    rig.run(2);
    EXPECT_EQ(rig.state(), 6);
    reset(rig);
    rig.runUntilState(2);
    rig.inject("collision");
    rig.runSeconds(1);
    EXPECT_EQ(rig.state(), 2);
    rig.runSeconds(11);
    rig.inject("collision");
    rig.run(2);
    EXPECT_EQ(rig.state(), 6);
}

TEST(Machine, BrakesWhenTheWorldPressesHarderThanTheLimit) {
    Rig rig;
    rig.effect.wrench.force = {0, 0, 49};
    rig.run(5);
    EXPECT_EQ(rig.state(), 2);
    rig.effect.wrench.force = {0, 0, 51};
    rig.run(2);
    EXPECT_EQ(rig.state(), 6);
}

TEST(Machine, DoesNotLeaveTheBrakesWhileTheEmergencyStopIsPressed) {
    Rig rig;
    rig.inject("emergency-stop");
    rig.run(2);
    EXPECT_EQ(rig.state(), 6);
    EXPECT_EQ(rig.opcode() & kEmergencyStop, kEmergencyStop);
    reset(rig);
    rig.runSeconds(2);
    EXPECT_EQ(rig.state(), 6);
    rig.inject("release-emergency-stop");
    rig.run(2);
    EXPECT_EQ(rig.state(), 6);
    EXPECT_EQ(rig.opcode() & kEmergencyStop, 0U);
    reset(rig);
    EXPECT_TRUE(rig.runUntilState(2));
}

TEST(Machine, LosesItsCalibration) {
    Rig rig;
    rig.inject("uncalibrate");
    rig.run(2);
    EXPECT_EQ(rig.state(), 1);
    EXPECT_EQ(rig.opcode(), kUncalibrated);
    rig.moveJoints({1, 1, 1, 1, 1, 1});
    rig.runSeconds(1);
    EXPECT_EQ(rig.state(), 1);
    EXPECT_THAT(rig.feedback(), IsEmpty());
}

TEST(Machine, MakesThePresentPoseTheZeroOfTheCalibratedAxes) {
    Rig rig;
    rig.run(2);
    const double before = rig.joint(2);
    EXPECT_NEAR(before, 90.0, 1e-9);
    const auto flange = rig.report.base_from_flange->translation;
    calibrate(rig, 4);
    rig.runSeconds(1);
    EXPECT_EQ(rig.state(), 2);
    EXPECT_NEAR(rig.joint(2), 0.0, 1e-9);
    EXPECT_NEAR((rig.report.base_from_flange->translation - flange).norm(), 0.0, 1e-9);
    EXPECT_EQ(rig.client.call("/calibration_counter_srv")["cnt"], 1);
}

TEST(Machine, DropsWhatAStateDoesNotAllowWithoutAWord) {
    Rig cold({.ready = false});
    reset(cold);
    calibrate(cold);
    cold.moveJoints({1, 1, 1, 1, 1, 1});
    cold.client.publish("/bridge_jog", {{"move_command", 74}, {"move_type", 74}});
    cold.runSeconds(1);
    EXPECT_EQ(cold.state(), 0);
    EXPECT_THAT(cold.feedback(), IsEmpty());

    Rig braked;
    braked.inject("brake");
    braked.run(2);
    calibrate(braked);
    init(braked);
    braked.moveJoints({1, 1, 1, 1, 1, 1});
    braked.runSeconds(1);
    EXPECT_EQ(braked.state(), 6);
    EXPECT_THAT(braked.feedback(), IsEmpty());

    Rig calibrated;
    reset(calibrated);
    calibrated.runSeconds(1);
    EXPECT_THAT(calibrated.states, ElementsAre(2));
}

TEST(Machine, LosesTheNextCommandsWhenTold) {
    Rig rig;
    EXPECT_FALSE(rig.inject("drop-next", "0"));
    EXPECT_TRUE(rig.inject("drop-next", "2"));
    rig.moveJoints({1, 1, 1, 1, 1, 1});
    calibrate(rig);
    rig.runSeconds(1);
    EXPECT_THAT(rig.states, ElementsAre(2));
    rig.moveJoints({1, 1, 1, 1, 1, 1});
    EXPECT_EQ(rig.state(), 3);
}

TEST(Machine, BrakesWhenTheHeartbeatStops) {
    Rig rig;
    rig.client.publish("/tablet_HB_start", {{"data", true}});
    for (int beat = 0; beat < 4; ++beat) {
        rig.client.publish("/tablet_HB", {{"data", 1}});
        rig.runSeconds(0.9);
        EXPECT_EQ(rig.state(), 2);
    }
    rig.runSeconds(2.0);
    EXPECT_EQ(rig.state(), 6);
}

TEST(Machine, ChecksItsBrakes) {
    Rig rig;
    rig.client.subscribe("/brakes_check_ack");
    rig.client.publish("/brakes_check_start", {{"data", true}});
    rig.run(2);
    EXPECT_EQ(rig.state(), 7);
    EXPECT_TRUE(rig.runUntilState(2));
    EXPECT_EQ(rig.client.last("/brakes_check_ack"), Json({{"state", 1}, {"mask", 7}}));
}

TEST(Machine, BrakesByAFollowingErrorAndAtTheEndOfAStrokeUntilAReset) {
    for (const auto* fault : {"following-error", "limit"}) {
        Rig rig;
        rig.moveJoints({30.0});
        rig.runSeconds(0.3);
        ASSERT_TRUE(rig.inject(fault, "6"));
        EXPECT_TRUE(rig.runUntilState(static_cast<int>(MachineState::braked))) << fault;
        rig.runSeconds(1.0);
        const double stopped = rig.joint(0);
        rig.runSeconds(1.0);
        EXPECT_EQ(rig.joint(0), stopped) << fault;
        EXPECT_LT(stopped, 29.0) << fault;
    }
}

TEST(Machine, TakesInjectionsUpToTheirLimits) {
    Rig rig;
    for (const auto& [name, most] :
         {std::pair("limit", 6), {"joint-silent", 7}, {"drop-next", 1'000'000}}) {
        EXPECT_TRUE(rig.inject(name, std::to_string(most))) << name;
        for (const auto& value :
             {std::to_string(most + 1), std::string("-1"), std::string(), std::string("1.5")}) {
            EXPECT_FALSE(rig.inject(name, value)) << name << ' ' << value;
        }
    }
    EXPECT_FALSE(rig.inject("limit", "0"));
    EXPECT_FALSE(rig.inject("drop-next", "0"));
    EXPECT_TRUE(rig.inject("joint-silent", "0"));
}

TEST(Machine, RefusesInjectionsItDoesNotKnow) {
    Rig rig;
    EXPECT_EQ(rig.inject("fire").error().code, Errc::not_found);
    EXPECT_EQ(rig.inject("limit", "7").error().code, Errc::invalid_argument);
    EXPECT_EQ(rig.inject("joint-silent", "x").error().code, Errc::invalid_argument);
    EXPECT_GT(rig.robot.injections().size(), 8U);
}

}  // namespace
}  // namespace metier::virtual_edo
