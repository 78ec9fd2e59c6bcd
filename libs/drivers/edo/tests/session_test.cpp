#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "session_bench.hpp"

namespace metier::edo_driver {
namespace {

using device::EndCause;
using device::SafetyState;
using testing::Bench;
using ::testing::HasSubstr;
using testing::kClassic;
using testing::kExternal;

constexpr double kStep = 0.001;  // [rad]; 0.1 rad/s

// ---- both generations ----

class BothGenerations : public ::testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Edo, BothGenerations, ::testing::Values(kClassic, kExternal),
                         [](const auto& of) {
                             return std::string(of.param == kClassic ? "Classic" : "External");
                         });

TEST_P(BothGenerations, StartsWithTheVersionAndFollowsTheRobot) {
    Bench bench(GetParam());
    bench.start();
    EXPECT_EQ(bench.safety(), SafetyState::normal) << bench.text();
    ASSERT_FALSE(bench.robot.received.empty());
    EXPECT_THAT(bench.robot.received.front(), HasSubstr("/machine_bridge_sw_version_srv"));
    EXPECT_EQ(bench.robot.count("throttle_rate"), 0);
    EXPECT_EQ(bench.robot.count("/bridge_init\",\"msg"), 0) << "nothing is commanded by itself";
    EXPECT_NEAR(bench.core.state().position[2], std::numbers::pi / 2, 1e-9);
    EXPECT_TRUE(bench.core.state().standstill);
}

TEST_P(BothGenerations, FollowsASourceToItsEndAndGivesControlBack) {
    Bench bench(GetParam());
    bench.start();
    const auto source = bench.attach(kStep, 100);
    ASSERT_TRUE(bench.attached);
    ASSERT_TRUE(bench.runUntil([&] { return !source->ends.empty(); })) << bench.text();
    EXPECT_EQ(source->ends.front().first, EndCause::done);
    EXPECT_NEAR(bench.core.state().commanded_position[0], 100 * kStep, 1e-9);
    EXPECT_TRUE(bench.robot.control_taken);
    ASSERT_TRUE(bench.runUntil([&] { return !bench.robot.control_taken; }, 2000));
    bench.run(200);
    EXPECT_EQ(bench.safety(), SafetyState::normal) << bench.text();
    EXPECT_NEAR(bench.core.state().position[0], 100 * kStep, 1e-6);
    EXPECT_EQ(bench.robot.set_points_while_not_taken, 0);
    EXPECT_LT(bench.robot.longest_step, 0.06);
}

TEST_P(BothGenerations, HoldsTheGripperWhileItMovesTheArm) {
    Bench bench(GetParam());
    bench.robot.joints[6] = 33.0;
    bench.start();
    const auto source = bench.attach(kStep, 50);
    ASSERT_TRUE(bench.runUntil([&] { return !source->ends.empty(); }));
    EXPECT_NEAR(bench.robot.joints[6], 33.0, 1e-4);
}

TEST_P(BothGenerations, GoesOnWithTheNextSourceWhileItStillHasControl) {
    Bench bench(GetParam());
    bench.start();
    const auto first = bench.attach(kStep, 10);
    ASSERT_TRUE(bench.runUntil([&] { return !first->ends.empty(); }));
    const auto calls = bench.robot.count("/algo_control_switch_srv");
    const auto second = bench.attach(kStep, 10);
    ASSERT_TRUE(bench.attached);
    ASSERT_TRUE(bench.runUntil([&] { return !second->ends.empty(); }));
    EXPECT_EQ(bench.robot.count("/algo_control_switch_srv"), calls);
    EXPECT_NEAR(bench.core.state().commanded_position[0], 20 * kStep, 1e-9);
}

TEST_P(BothGenerations, StopBrakesByItselfAndEndsAtStandstill) {
    Bench bench(GetParam());
    bench.start();
    const auto source = bench.attach(0.003, 1000);  // 0.3 rad/s
    ASSERT_TRUE(bench.runUntil([&] { return source->asked >= 50; }));
    bench.core.stop();
    const double at = bench.core.state().commanded_position[0];
    ASSERT_TRUE(bench.runUntil([&] { return !source->ends.empty(); }, 2000));
    EXPECT_EQ(source->ends.front().first, EndCause::stopped);
    // 2 * 45.6 deg/s2 = 1.59 rad/s2: 0.028 rad from 0.3 rad/s.
    EXPECT_NEAR(bench.core.state().commanded_position[0] - at, 0.028, 0.006);
    EXPECT_TRUE(bench.core.state().standstill);
    ASSERT_TRUE(bench.runUntil([&] { return !bench.robot.control_taken; }, 2000));
    EXPECT_EQ(bench.safety(), SafetyState::normal);
}

TEST_P(BothGenerations, TellsWhenControlIsRefused) {
    Bench bench(GetParam());
    bench.robot.faults.refuse_control = true;
    bench.start();
    const auto source = bench.attach(kStep, 100);
    ASSERT_TRUE(bench.runUntil([&] { return !source->ends.empty(); }, 5000));
    EXPECT_EQ(source->ends.front().first, EndCause::safety);
    EXPECT_EQ(source->asked, 0);
    EXPECT_EQ(bench.safety(), SafetyState::protective_stop);
    EXPECT_THAT(bench.text(), HasSubstr("edo: control was not handed over: refused with result 1"));
    EXPECT_FALSE(bench.attach(kStep, 1) && bench.attached);
}

TEST_P(BothGenerations, TellsWhenControlIsGrantedButNotGiven) {
    Bench bench(GetParam());
    bench.robot.faults.grant_without_doing = true;
    bench.start();
    const auto source = bench.attach(kStep, 100);
    ASSERT_TRUE(bench.runUntil([&] { return !source->ends.empty(); }, 5000));
    EXPECT_EQ(source->asked, 0);
    EXPECT_THAT(bench.text(), HasSubstr("answered, but the algorithm state is 5"));
}

TEST_P(BothGenerations, TellsWhenTheServiceNeverAnswers) {
    Bench bench(GetParam());
    bench.start();
    bench.robot.faults.mute_services = true;
    const auto source = bench.attach(kStep, 100);
    ASSERT_TRUE(bench.runUntil([&] { return !source->ends.empty(); }, 5000));
    EXPECT_THAT(bench.text(), HasSubstr("no answer of the service within 2 s"));
}

TEST_P(BothGenerations, TellsWhenControlIsNotTakenBack) {
    Bench bench(GetParam());
    bench.start();
    bench.robot.faults.keep_control = true;
    const auto source = bench.attach(kStep, 5);
    ASSERT_TRUE(bench.runUntil([&] { return bench.safety() != SafetyState::normal; }, 5000));
    EXPECT_THAT(bench.text(), HasSubstr("control was not taken back"));
    EXPECT_EQ(source->ends.front().first, EndCause::done);
}

TEST_P(BothGenerations, AResetGivesBackWhatWasLeftTaken) {
    Bench bench(GetParam());
    bench.robot.control_taken = true;  // by a client that is no more
    bench.start();
    bench.attach(kStep, 100);
    ASSERT_TRUE(bench.runUntil([&] { return bench.safety() != SafetyState::normal; }, 5000));
    ASSERT_TRUE(bench.reset()) << bench.text();
    EXPECT_FALSE(bench.robot.control_taken);
    const auto source = bench.attach(kStep, 10);
    ASSERT_TRUE(bench.attached);
    ASSERT_TRUE(bench.runUntil([&] { return !source->ends.empty(); }, 5000));
    EXPECT_EQ(source->ends.front().first, EndCause::done);
}

TEST_P(BothGenerations, NoticesSetPointsThatAreDropped) {
    Bench bench(GetParam());
    bench.robot.faults.drop_set_points = true;
    bench.start();
    const auto source = bench.attach(0.003, 1000);
    ASSERT_TRUE(bench.runUntil([&] { return !source->ends.empty(); }, 5000));
    EXPECT_EQ(source->ends.front().first, EndCause::safety);
    EXPECT_EQ(bench.safety(), SafetyState::protective_stop);
    EXPECT_THAT(bench.text(), HasSubstr("axis 1 does not follow"));
    EXPECT_LT(source->asked, 80) << "0.1 rad at 0.3 rad/s and 0.3 s more";
    bench.robot.faults.drop_set_points = false;
    EXPECT_TRUE(bench.reset()) << bench.text();
}

TEST_P(BothGenerations, TheLinkIsLostWhileItMoves) {
    Bench bench(GetParam());
    bench.start();
    const auto source = bench.attach(kStep, 1000);
    ASSERT_TRUE(bench.runUntil([&] { return source->asked >= 10; }));
    bench.session.linkDown("10.42.0.49:9090: the server closed the connection");
    bench.core.dispatch();
    ASSERT_EQ(source->ends.size(), 1U);
    EXPECT_EQ(source->ends.front().first, EndCause::disconnected);
    EXPECT_EQ(bench.text(), "edo: 10.42.0.49:9090: the server closed the connection");

    bench.start();  // again
    EXPECT_TRUE(bench.runUntil([&] { return !bench.robot.control_taken; }, 2000))
        << "what it left taken is given back";
    bench.run(500);
    EXPECT_EQ(bench.safety(), SafetyState::normal) << bench.text();
    EXPECT_EQ(source->asked, 10) << "nothing moves by itself";
}

TEST_P(BothGenerations, ARobotThatRestartedIsStartedByAReset) {
    Bench bench(GetParam());
    bench.start();
    bench.session.linkDown("gone");
    bench.robot.restart();
    bench.start();
    EXPECT_EQ(bench.safety(), SafetyState::protective_stop);
    EXPECT_THAT(bench.text(), HasSubstr("INIT: not started"));
    ASSERT_TRUE(bench.reset()) << bench.text();
    EXPECT_EQ(bench.safety(), SafetyState::normal);
    EXPECT_EQ(bench.robot.count(R"("joints_mask":127,"reduction_factor":0.0)"), 1);
    EXPECT_EQ(bench.robot.count(R"("disengage_steps":2000,"disengage_offset":3.5)"), 1);
    EXPECT_EQ(bench.robot.count("calib"), 0);
}

TEST_P(BothGenerations, AnotherClientThatTakesControlAwayIsNoticed) {
    Bench bench(GetParam());
    bench.start();
    const auto source = bench.attach(kStep, 1000);
    ASSERT_TRUE(bench.runUntil([&] { return source->asked >= 10; }));
    bench.robot.control_taken = false;
    ASSERT_TRUE(bench.runUntil([&] { return !source->ends.empty(); }, 2000));
    EXPECT_EQ(source->ends.front().first, EndCause::safety);
    EXPECT_THAT(bench.text(), HasSubstr("control was taken away"));
}

TEST_P(BothGenerations, ARobotWithoutAlgorithmStateIsBelieved) {
    Bench bench(GetParam());
    bench.robot.faults.mute_algorithm = true;
    bench.start();
    const auto source = bench.attach(kStep, 10);
    ASSERT_TRUE(bench.runUntil([&] { return !source->ends.empty(); }));
    EXPECT_EQ(source->ends.front().first, EndCause::done) << bench.text();
    EXPECT_TRUE(bench.runUntil([&] { return !bench.robot.control_taken; }, 2000));
}

TEST(Session, UnderstandsTheHoldStateOfVersion210) {
    Bench bench("edo_2.1.0");
    bench.robot.switched_off_state = 8;
    bench.robot.tells_switched_off = true;
    bench.start();
    const auto source = bench.attach(kStep, 10);
    ASSERT_TRUE(bench.runUntil([&] { return !source->ends.empty(); }));
    EXPECT_EQ(source->ends.front().first, EndCause::done) << bench.text();
}

TEST_P(BothGenerations, AStopBeforeControlIsTakenEndsItAtOnce) {
    Bench bench(GetParam());
    bench.start();
    const auto source = bench.attach(kStep, 100);
    bench.core.stop();
    ASSERT_TRUE(bench.runUntil([&] { return !source->ends.empty(); }, 200));
    EXPECT_EQ(source->ends.front().first, EndCause::stopped);
    EXPECT_EQ(source->asked, 0);
    EXPECT_EQ(bench.robot.count("/algo_control_switch_srv"), 0) << "control is not asked for";
}

TEST_P(BothGenerations, WorksWithoutAGripper) {
    auto options = testing::benchOptions();
    options.layout.gripper = false;
    Bench bench(GetParam(), options);
    bench.robot.joint_count = 6;
    bench.start();
    EXPECT_EQ(bench.safety(), SafetyState::normal) << bench.text();
    const auto source = bench.attach(kStep, 10);
    ASSERT_TRUE(bench.runUntil([&] { return !source->ends.empty(); }));
    EXPECT_EQ(source->ends.front().first, EndCause::done) << bench.text();
    EXPECT_NEAR(bench.core.state().position[0], 10 * kStep, 1e-6);
}

TEST_P(BothGenerations, WhatWasLeftTakenIsGivenBackAlsoAfterAConnectionThatWasUsedForNothing) {
    Bench bench(GetParam());
    bench.start();
    const auto source = bench.attach(kStep, 1000);
    ASSERT_TRUE(bench.runUntil([&] { return source->asked >= 10; }));
    bench.session.linkDown("gone");
    bench.connect();
    bench.session.linkDown("gone again");
    bench.start();
    EXPECT_TRUE(bench.runUntil([&] { return !bench.robot.control_taken; }, 2000));
    EXPECT_EQ(bench.safety(), SafetyState::normal) << bench.text();
}

// ---- set-points ----

TEST(Session, SendsOneSetPointPerCycleAlthoughJointStatesComeInBunches) {
    Bench bench;
    bench.start();
    const auto source = bench.attach(kStep, 1000);
    ASSERT_TRUE(bench.runUntil([&] { return source->asked >= 10; }));
    const int before = bench.robot.set_points;
    for (int bunch = 0; bunch < 10; ++bunch) {
        bench.now += std::chrono::milliseconds(40);
        for (int i = 0; i < 4; ++i) {
            bench.now -= std::chrono::milliseconds(10);
            bench.cycle();
        }
    }
    EXPECT_EQ(bench.robot.set_points - before, 10);
    EXPECT_LT(bench.robot.longest_step, 0.06);
}

TEST(Session, RefusesASetPointThatIsNoNumber) {
    Bench bench;
    bench.start();
    const auto source = bench.attach(std::nan(""), 1000);
    ASSERT_TRUE(bench.runUntil([&] { return !source->ends.empty(); }, 5000));
    EXPECT_TRUE(source->ends.front().second.limit_violated);
    EXPECT_THAT(bench.text(), HasSubstr("axis 1: a set-point that is no number"));
    EXPECT_TRUE(bench.reset());
}

TEST(Session, RefusesAJump) {
    Bench bench;
    bench.start();
    const auto source = bench.attach(0.1, 1000);
    ASSERT_TRUE(bench.runUntil([&] { return !source->ends.empty(); }, 5000));
    EXPECT_THAT(bench.text(), HasSubstr("axis 1: set-point at 10.0000 rad/s"));
    EXPECT_EQ(bench.robot.longest_step, 0.0);
}

// ---- safety ----

TEST(Session, TheRobotBrakesWhileItMoves) {
    Bench bench;
    bench.start();
    const auto source = bench.attach(kStep, 1000);
    ASSERT_TRUE(bench.runUntil([&] { return source->asked >= 10; }));
    bench.robot.brake(1U << 9U);
    ASSERT_TRUE(bench.runUntil([&] { return !source->ends.empty(); }, 2000));
    EXPECT_EQ(source->ends.front().first, EndCause::safety);
    EXPECT_EQ(bench.safety(), SafetyState::protective_stop);
    EXPECT_THAT(bench.text(), HasSubstr("edo: BRAKED (collision)"));
    const int sent = bench.robot.set_points;
    bench.run(500);
    EXPECT_EQ(bench.robot.set_points, sent);
    ASSERT_TRUE(bench.reset()) << bench.text();
    EXPECT_FALSE(bench.robot.control_taken);
    EXPECT_EQ(bench.safety(), SafetyState::normal);
}

TEST_P(BothGenerations, ABrakeThatTakesControlBackIsNoFault) {
    Bench bench(GetParam());
    bench.start();
    const auto source = bench.attach(kStep, 1000);
    ASSERT_TRUE(bench.runUntil([&] { return source->asked >= 10; }));
    bench.robot.brake(1U << 9U);
    bench.robot.control_taken = false;
    bench.run(1500);
    EXPECT_THAT(bench.text(), HasSubstr("edo: BRAKED (collision)"));
    bench.robot.restart();
    bench.robot.state = 2;
    bench.run(500);
    EXPECT_EQ(bench.safety(), SafetyState::normal) << bench.text();
}

TEST(Session, ARobotWhoseVelocitiesAreNoiseStandsTwoSecondsAfterItsBrake) {
    Bench bench;
    bench.start();
    const auto source = bench.attach(kStep, 1000);
    ASSERT_TRUE(bench.runUntil([&] { return source->asked >= 10; }));
    bench.robot.faults.restless = true;
    bench.robot.brake(1U << 9U);
    ASSERT_TRUE(bench.runUntil([&] { return bench.safety() != SafetyState::normal; }, 500));
    bench.run(1900);
    EXPECT_TRUE(source->ends.empty());
    bench.run(200);
    ASSERT_EQ(source->ends.size(), 1U);
    EXPECT_EQ(source->ends.front().first, EndCause::safety);
}

TEST(Session, NamesAnEmergencyStop) {
    Bench bench;
    bench.start();
    bench.robot.brake(1U << 7U);
    bench.robot.faults.brakes_stay_closed = true;
    bench.run(200);
    EXPECT_EQ(bench.safety(), SafetyState::emergency_stop);
    EXPECT_THAT(bench.text(), HasSubstr("emergency stop"));
    const auto reset = bench.reset();
    ASSERT_FALSE(reset);
    EXPECT_EQ(reset.error().code, Errc::device_fault);
    EXPECT_THAT(reset.error().message, HasSubstr("BRAKED"));
}

TEST(Session, ARobotThatIsNotCalibratedNeedsAPerson) {
    Bench bench;
    bench.robot.restart();
    bench.robot.uncalibrated = true;
    bench.start();
    const auto reset = bench.reset();
    ASSERT_FALSE(reset);
    EXPECT_THAT(reset.error().message, HasSubstr("edo: NOT_CALIBRATED"));
    EXPECT_THAT(reset.error().message, HasSubstr("a person must"));
    EXPECT_EQ(bench.safety(), SafetyState::fault);
    EXPECT_EQ(bench.robot.count("calib"), 0);
}

TEST(Session, NoticesADroppedStartUpAndADroppedReset) {
    Bench bench;
    bench.robot.restart();
    bench.robot.faults.drop_init = true;
    bench.start();
    EXPECT_THAT(bench.reset().error().message,
                HasSubstr("dropped the start-up without a word: still INIT"));
    bench.robot.faults.drop_init = false;
    bench.robot.faults.drop_reset = true;
    EXPECT_THAT(bench.reset().error().message,
                HasSubstr("dropped the reset without a word: still BRAKED"));
    bench.robot.faults.drop_reset = false;
    EXPECT_TRUE(bench.reset());
}

TEST(Session, WhoAsksAgainForAResetHearsItsEnd) {
    Bench bench;
    bench.start();
    bench.robot.brake(1U << 6U);
    bench.robot.faults.drop_reset = true;
    bench.run(200);
    auto& slot = bench.session.resetSlot();
    EXPECT_FALSE(slot.ask());
    EXPECT_FALSE(slot.ask());
    bench.run(3000);
    EXPECT_THAT(slot.ask().value().error().message, HasSubstr("dropped the reset"));
    EXPECT_FALSE(slot.ask()) << "a new one";
    EXPECT_EQ(bench.robot.count("/bridge_jnt_reset\",\"msg"), 1);
    bench.cycle();
    EXPECT_EQ(bench.robot.count("/bridge_jnt_reset\",\"msg"), 2);
}

TEST(Session, AnErrorOfTheRobotNeedsARestart) {
    Bench bench;
    bench.start();
    bench.robot.state = 5;
    bench.robot.opcode = 1U << 2U;
    bench.run(200);
    EXPECT_EQ(bench.safety(), SafetyState::fault);
    EXPECT_THAT(bench.reset().error().message,
                HasSubstr("ERROR (overcurrent): the robot must be restarted"));
}

TEST(Session, CanStartTheRobotOnceByItself) {
    auto options = testing::benchOptions();
    options.start_on_connect = true;
    Bench bench(kExternal, options);
    bench.robot.restart();
    bench.start();
    EXPECT_TRUE(bench.runUntil([&] { return bench.safety() == SafetyState::normal; }, 5000));
    bench.session.linkDown("gone");
    bench.robot.restart();
    bench.start();
    bench.run(3000);
    EXPECT_EQ(bench.safety(), SafetyState::protective_stop) << "once only";
}

TEST(Session, DoesNotStartByItselfARobotThatIsReady) {
    auto options = testing::benchOptions();
    options.start_on_connect = true;
    Bench bench(kExternal, options);
    bench.start();
    bench.run(1000);
    EXPECT_EQ(bench.safety(), SafetyState::normal) << bench.text();
    bench.robot.brake(1U << 9U);
    bench.run(3000);
    EXPECT_EQ(bench.safety(), SafetyState::protective_stop) << "only what it found on connecting";
    EXPECT_EQ(bench.robot.count("/bridge_jnt_reset\",\"msg"), 0);
}

TEST(Session, ClosesByBrakingAndGivingControlBack) {
    Bench bench;
    bench.start();
    const auto source = bench.attach(0.003, 1000);
    ASSERT_TRUE(bench.runUntil([&] { return source->asked >= 50; }));
    EXPECT_FALSE(bench.session.closed());
    bench.session.close();
    ASSERT_TRUE(bench.runUntil([&] { return bench.session.closed(); }, 2000));
    EXPECT_FALSE(bench.robot.control_taken);
    EXPECT_EQ(source->ends.front().first, EndCause::stopped);
}

}  // namespace
}  // namespace metier::edo_driver
