// Messages that do not come, or are not what they should be.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "session_bench.hpp"

namespace metier::edo_driver {
namespace {

using device::EndCause;
using device::SafetyState;
using testing::Bench;
using ::testing::HasSubstr;
using testing::kExternal;

constexpr double kStep = 0.001;  // [rad]; 0.1 rad/s

TEST(Session, SilentJointsAreADisconnection) {
    Bench bench;
    bench.start();
    const auto source = bench.attach(kStep, 1000);
    ASSERT_TRUE(bench.runUntil([&] { return source->asked >= 10; }));
    bench.robot.faults.mute_joints = true;
    ASSERT_TRUE(bench.runUntil([&] { return !source->ends.empty(); }, 150));
    EXPECT_EQ(source->ends.front().first, EndCause::disconnected);
    EXPECT_THAT(bench.text(), HasSubstr("edo: no joint states for 100 ms"));
    bench.robot.faults.mute_joints = false;
    bench.run(100);
    EXPECT_EQ(bench.safety(), SafetyState::normal);
    EXPECT_TRUE(bench.runUntil([&] { return !bench.robot.control_taken; }, 2000));
}

TEST(Session, ASilentMachineStateIsADisconnection) {
    Bench bench;
    bench.start();
    bench.robot.faults.mute_machine = true;
    ASSERT_TRUE(bench.runUntil([&] { return bench.safety() != SafetyState::normal; }, 1500));
    EXPECT_EQ(bench.safety(), SafetyState::disconnected);
    EXPECT_THAT(bench.text(), HasSubstr("no machine state for 1000 ms"));
}

TEST(Session, PositionsThatAreNullAreNoJointStates) {
    Bench bench;
    bench.start();
    bench.robot.faults.null_positions = true;
    bench.run(200);
    EXPECT_EQ(bench.safety(), SafetyState::disconnected);
}

TEST(Session, PositionsThatNoJointCanHaveAreNoJointStates) {
    Bench bench;
    bench.start();
    const auto before = bench.core.state().position[1];
    bench.robot.joints[1] = 1.2e3;  // [deg], of which a changed byte makes 1.203
    bench.run(5);
    EXPECT_EQ(bench.core.state().position[1], before);
    bench.run(200);
    EXPECT_EQ(bench.safety(), SafetyState::disconnected);
}

TEST(Session, ARobotThatSaysNothingIsLeft) {
    Bench bench;
    bench.connect();
    bench.robot.faults = {.mute_joints = true, .mute_machine = true, .mute_algorithm = true};
    ASSERT_TRUE(bench.runUntil([&] { return !bench.ticked; }, 5000));
    EXPECT_EQ(bench.ticked.error().code, Errc::connection_lost);
}

TEST(Session, AVersionThatNeverComesIsTold) {
    Bench bench;
    bench.robot.faults.mute_services = true;
    bench.connect();
    ASSERT_TRUE(bench.runUntil([&] { return !bench.ticked; }, 5000));
    EXPECT_THAT(bench.ticked.error().message, HasSubstr("machine_bridge_sw_version_srv"));
}

TEST(Session, IsNotTroubledByMessagesThatItDoesNotUnderstand) {
    Bench bench;
    bench.start();
    const auto source = bench.attach(kStep, 100);
    ASSERT_TRUE(bench.runUntil([&] { return source->asked >= 10; }));
    for (const auto* text : {"", "{", R"({"op":"publish","topic":"/machine_state"})",
                             R"({"op":"status","level":"error","msg":"no type"})",
                             R"({"op":"service_response","id":"somebody's","result":false})"}) {
        bench.session.onText(text, bench.now, bench);
        bench.run(20);
    }
    ASSERT_TRUE(bench.runUntil([&] { return !source->ends.empty(); }));
    EXPECT_EQ(source->ends.front().first, EndCause::done) << bench.text();
}

TEST(Session, AnyMessageShowsThatTheRobotIsThere) {
    Bench bench;
    bench.start();
    bench.robot.faults = {.mute_joints = true, .mute_machine = true, .mute_algorithm = true};
    for (int i = 0; i < 5; ++i) {
        bench.run(2000);
        bench.session.onText("{", bench.now, bench);
    }
    EXPECT_TRUE(bench.ticked);
    EXPECT_TRUE(bench.runUntil([&] { return !bench.ticked; }, 3100));
    EXPECT_EQ(bench.ticked.error().message, "no message within 3 s");
}

TEST(Session, AVelocityThatIsNullIsTakenForRest) {
    Bench bench;
    bench.start();
    bench.robot.faults.restless = true;
    bench.run(20);
    EXPECT_FALSE(bench.core.state().standstill);
    std::string joints;
    for (int i = 0; i < 7; ++i) {
        joints += std::string(i > 0 ? "," : "") + R"({"position":1.0,"velocity":null})";
    }
    bench.session.onText(
        R"({"op":"publish","topic":"/usb_jnt_state","msg":{"joints":[)" + joints + "]}}", bench.now,
        bench);
    EXPECT_TRUE(bench.core.state().standstill);
    EXPECT_EQ(bench.core.state().velocity[0], 0.0);
}

TEST(Session, CountsTheCyclesThatCameLate) {
    Bench bench;
    bench.start();
    const auto before = bench.core.state();
    bench.run(100);
    EXPECT_EQ(bench.core.state().cycle, before.cycle + 10);
    EXPECT_EQ(bench.core.state().missed_cycles, 0U);
    bench.now += std::chrono::milliseconds(15);
    bench.run(20);
    EXPECT_EQ(bench.core.state().missed_cycles, 1U);
    bench.session.linkDown("gone");
    bench.start();
    EXPECT_EQ(bench.core.state().missed_cycles, 0U) << "each connection counts anew";
}

TEST(Session, AnUnknownVersionNeedsASetting) {
    Bench bench("edo_9.0.0");
    bench.start();
    EXPECT_EQ(bench.safety(), SafetyState::fault);
    EXPECT_THAT(bench.text(), HasSubstr("software version 'edo_9.0.0' is not known"));

    auto options = testing::benchOptions();
    options.generation = externalGeneration();
    Bench told("edo_9.0.0", options);
    told.start();
    EXPECT_EQ(told.safety(), SafetyState::normal) << told.text();
}

TEST(Session, AnotherNumberOfJointsIsAFault) {
    Bench bench;
    bench.robot.joint_count = 6;
    bench.start();
    EXPECT_EQ(bench.safety(), SafetyState::fault);
    EXPECT_THAT(bench.text(), HasSubstr("the robot has 6 joints"));
}

TEST(Session, AResetTellsWhatStaysWrong) {
    Bench bench;
    bench.robot.joint_count = 6;
    bench.start();
    const auto reset = bench.reset();
    ASSERT_FALSE(reset);
    EXPECT_EQ(reset.error().code, Errc::device_fault);
    EXPECT_THAT(reset.error().message,
                HasSubstr("edo: the robot has 6 joints, the settings say 6 axes and a gripper"));
    auto options = testing::benchOptions();
    options.layout.gripper = false;
    Bench without(kExternal, options);
    without.start();
    EXPECT_THAT(without.text(),
                HasSubstr("has 7 joints, the settings say 6 axes without a gripper"));
}

TEST(Session, JointsThatVanishEndAMotion) {
    Bench bench;
    bench.start();
    const auto source = bench.attach(kStep, 1000);
    ASSERT_TRUE(bench.runUntil([&] { return source->asked >= 10; }));
    bench.robot.joint_count = 6;
    ASSERT_TRUE(bench.runUntil([&] { return !source->ends.empty(); }, 500));
    EXPECT_EQ(source->ends.front().first, EndCause::disconnected);
    bench.run(100);
    EXPECT_THAT(bench.text(), HasSubstr("the robot has 6 joints"));
}

}  // namespace
}  // namespace metier::edo_driver
