#include <gmock/gmock.h>

#include "gripper_bench.hpp"
#include "metier/robot_skills/device_watch.hpp"

namespace metier::robot_skills {
namespace {

using device::SafetyState;
using skill::State;
using skill::SubState;
using ::testing::HasSubstr;

const device::Safety kLost{SafetyState::disconnected, "tool: the cable was pulled", false};
const device::Safety kFault{SafetyState::fault, "tool: fast stop", false};

/// A grasp that is under way.
class MovingJaws : public ::testing::Test {
protected:
    MovingJaws() { EXPECT_TRUE(bench.start(kGrasp, {{"Force", 20.0}})); }

    void suspended() {
        ASSERT_TRUE(bench.run([&] { return grasp.suspend(bench.caller); }));
        EXPECT_EQ(grasp.state(), State::running) << "until the jaws stand";
        EXPECT_EQ(gripper.stops, 1);
        bench.end(fail(Errc::cancelled, "stopped"));
        ASSERT_EQ(grasp.state(), State::suspended);
    }

    GripperBench bench;
    HandDrivenGripper& gripper = bench.gripper;
    skill::Program& grasp = bench.program(kGrasp);
};

TEST_F(MovingJaws, ThatFindNoPartAreHaltedWithAnError) {
    bench.end(fail(Errc::device_fault, "tool: no part found: the jaws closed to 0.0 mm"));
    EXPECT_EQ(grasp.state(), State::halted);
    EXPECT_EQ(grasp.subState(), SubState::halted_error);
    EXPECT_EQ(grasp.reason(), skill::Reason::error);
    EXPECT_THAT(grasp.reasonText(), HasSubstr("no part found: the jaws closed to 0.0 mm"));
}

TEST_F(MovingJaws, ThatHoldNothingAreNotBelievedToHaveSucceeded) {
    bench.end(device::GripperOutcome{0.0, false});
    EXPECT_EQ(grasp.state(), State::halted);
    EXPECT_EQ(grasp.reasonText(), "no part found: the jaws closed to 0.0 mm");
}

TEST_F(MovingJaws, AreStoppedByHalt) {
    ASSERT_TRUE(bench.run([&] { return grasp.halt(bench.caller); }));
    EXPECT_EQ(grasp.state(), State::running);
    EXPECT_EQ(gripper.stops, 1);
    bench.end(fail(Errc::cancelled, "stopped"));
    EXPECT_EQ(grasp.state(), State::halted);
    EXPECT_EQ(grasp.subState(), SubState::halted_by_client);
}

TEST_F(MovingJaws, AreHaltedAlsoIfTheyWereDoneMeanwhile) {
    ASSERT_TRUE(bench.run([&] { return grasp.halt(bench.caller); }));
    bench.end(device::GripperOutcome{0.03, true});
    EXPECT_EQ(grasp.state(), State::halted);
}

TEST_F(MovingJaws, AreSuspendedAndMoveAgainAsBefore) {
    suspended();
    ASSERT_TRUE(bench.run([&] { return grasp.resume(bench.caller); }));
    EXPECT_EQ(grasp.state(), State::running);
    ASSERT_EQ(gripper.asked.size(), 2U);
    EXPECT_EQ(gripper.asked[1].motion, "grasp");
    EXPECT_EQ(gripper.asked[1].request.force, 20.0);
    bench.end(device::GripperOutcome{0.03, true});
    EXPECT_EQ(grasp.state(), State::ready);
}

TEST_F(MovingJaws, StaySuspendedIfTheGripperRefusesToMoveAgain) {
    suspended();
    gripper.ask_answer = fail(Errc::resource_unavailable, "tool: someone else moves the jaws");
    EXPECT_FALSE(bench.run([&] { return grasp.resume(bench.caller); }));
    EXPECT_EQ(grasp.state(), State::suspended);
    ASSERT_TRUE(bench.run([&] { return grasp.halt(bench.caller); }));
    EXPECT_EQ(grasp.state(), State::halted);
}

TEST_F(MovingJaws, ThatAreLostHaltTheSkillAsDeviceLost) {
    bench.end(fail(Errc::connection_lost, kLost.text));
    EXPECT_EQ(grasp.state(), State::halted);
    EXPECT_EQ(grasp.subState(), SubState::halted_device_lost);
    EXPECT_EQ(grasp.reasonText(), kLost.text);
}

TEST_F(MovingJaws, ThatAreLostWhileTheyRestHaltTheSkill) {
    suspended();
    bench.setSafety(kLost);
    EXPECT_EQ(grasp.state(), State::halted);
    EXPECT_EQ(grasp.subState(), SubState::halted_device_lost);
}

TEST_F(MovingJaws, ThatFallIntoAFaultWhileTheyRestHaltTheSkill) {
    suspended();
    bench.setSafety(kFault);
    EXPECT_EQ(grasp.subState(), SubState::halted_error);
    EXPECT_EQ(grasp.reasonText(), "tool: fast stop");
}

TEST_F(MovingJaws, TellAFaultByTheEndOfTheMotion) {
    bench.setSafety(kFault);
    EXPECT_EQ(grasp.state(), State::running);
    bench.end(fail(Errc::device_fault, "tool: grasp ended by the gripper: fast stop"));
    EXPECT_EQ(grasp.reasonText(), "tool: grasp ended by the gripper: fast stop");
}

TEST_F(MovingJaws, AreStoppedWhenTheDeadlineToRestHasPassed) {
    ASSERT_TRUE(bench.run([&] { return grasp.halt(bench.caller); }));
    bench.executor->advance(std::chrono::seconds(6));
    EXPECT_EQ(grasp.state(), State::halted);
    EXPECT_GE(gripper.stops, 2);
    bench.end(device::GripperOutcome{0.03, true});
    EXPECT_EQ(grasp.state(), State::halted) << "what comes late changes nothing";
}

TEST_F(MovingJaws, AreStoppedWhenTheProgramGoes) {
    bench.destroyProgram(kGrasp);
    EXPECT_GE(gripper.stops, 1);
    bench.end(fail(Errc::cancelled, "stopped"));
}

TEST(GripperSkill, IsHaltedIfTheGripperRefusesTheMotion) {
    GripperBench bench;
    bench.gripper.ask_answer = fail(Errc::device_fault, "tool: busy");
    ASSERT_TRUE(bench.start(kMove, {{"Width", 0.05}}));
    EXPECT_EQ(bench.program(kMove).state(), State::halted);
    EXPECT_EQ(bench.program(kMove).reasonText(), "tool: busy");
}

TEST(GripperSkill, OfReleaseThatStillHoldsThePartIsHalted) {
    GripperBench bench;
    ASSERT_TRUE(bench.start(kRelease));
    bench.end(device::GripperOutcome{0.03, true});
    EXPECT_EQ(bench.program(kRelease).reasonText(), "the part is still held at 30.0 mm");
}

TEST(GripperSkill, StaysHaltedUntilTheGripperAgreesToReset) {
    GripperBench bench;
    ASSERT_TRUE(bench.run([&] { return bench.program(kGrasp).halt(bench.caller); }));
    bench.gripper.reset_answer = fail(Errc::device_fault, "tool: power fault");
    EXPECT_FALSE(bench.run([&] { return bench.program(kGrasp).reset(bench.caller); }));
    EXPECT_EQ(bench.program(kGrasp).reasonText(), "tool: power fault");
    bench.gripper.reset_answer = {};
    EXPECT_TRUE(bench.run([&] { return bench.program(kGrasp).reset(bench.caller); }));
    EXPECT_EQ(bench.program(kGrasp).state(), State::ready);
}

TEST_F(MovingJaws, ThatDoNotStopAreNotReady) {
    ASSERT_TRUE(bench.run([&] { return grasp.halt(bench.caller); }));
    bench.executor->advance(std::chrono::seconds(5));
    ASSERT_EQ(grasp.state(), State::halted) << "not at rest in its time";
    const auto reset = bench.run([&] { return grasp.reset(bench.caller); });
    ASSERT_FALSE(reset);
    EXPECT_EQ(reset.error().code, Errc::timeout) << "to be called again";
    EXPECT_EQ(reset.error().message, "tool: the jaws still move");
    bench.end(fail(Errc::cancelled, "stopped"));
    ASSERT_TRUE(bench.run([&] { return grasp.reset(bench.caller); }));
    EXPECT_TRUE(bench.start(kGrasp)) << "Ready means that it can begin";
}

TEST_F(MovingJaws, LeaveTheResetOfAnotherSkillAlone) {
    auto& other = bench.program(kRelease);
    ASSERT_TRUE(bench.run([&] { return other.halt(bench.caller); }));
    EXPECT_TRUE(bench.run([&] { return other.reset(bench.caller); }));
}

TEST(GripperWatch, HaltsEveryProgramWhenTheGripperIsGone) {
    GripperBench bench;
    const DeviceWatch watch(bench.gripper, bench.executor,
                            {&bench.program(kGrasp), &bench.program(kMove)});
    bench.setSafety(kFault);
    EXPECT_EQ(bench.program(kGrasp).state(), State::halted) << "Reset is the way back";
    bench.setSafety(kLost);
    for (const auto& name : {kGrasp, kMove}) {
        EXPECT_EQ(bench.program(name).subState(), SubState::halted_device_lost);
        EXPECT_EQ(bench.program(name).reasonText(), kLost.text);
    }
}

}  // namespace
}  // namespace metier::robot_skills
