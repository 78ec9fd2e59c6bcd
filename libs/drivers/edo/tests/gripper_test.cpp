#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "session_bench.hpp"

namespace metier::edo_driver {
namespace {

using device::GripperOutcome;
using device::GripperRequest;
using testing::Bench;
using ::testing::HasSubstr;
using Kind = GripperTask::Kind;

class GripperTest : public ::testing::Test {
protected:
    void SetUp() override { bench_.start(); }

    void ask(Kind kind, const GripperRequest& request = {}) {
        outcome_.reset();
        const auto task = taskFor(kind, request, bench_.options.gripper);
        ASSERT_TRUE(task) << task.error().message;
        ASSERT_TRUE(bench_.session.gripperSlot().post(
            *task, [this](Result<GripperOutcome> outcome) { outcome_ = std::move(outcome); }));
    }
    /// Outcome of the motion, within 20 s of the robot.
    Result<GripperOutcome> ended() {
        bench_.runUntil([this] { return outcome_.has_value(); });
        return outcome_.value_or(fail(Errc::timeout, "never"));
    }
    Result<GripperOutcome> run(Kind kind, const GripperRequest& request = {}) {
        ask(kind, request);
        return ended();
    }
    device::GripperState state() const { return bench_.session.gripperState(); }

    Bench bench_;
    std::optional<Result<GripperOutcome>> outcome_;
};

TEST_F(GripperTest, OpensAndMovesToAWidth) {
    const auto released = run(Kind::release);
    ASSERT_TRUE(released) << released.error().message;
    EXPECT_NEAR(released->width, 0.08, 1e-4);
    EXPECT_FALSE(released->part_held);
    const auto moved = run(Kind::move, {.width = 0.02});
    ASSERT_TRUE(moved) << moved.error().message;
    EXPECT_NEAR(moved->width, 0.02, 1e-4);
    EXPECT_FALSE(state().part_held);
    EXPECT_NEAR(state().width, 0.02, 1e-4);
    EXPECT_EQ(bench_.robot.joints[2], 90.0) << "the axes stay";
}

TEST_F(GripperTest, GraspsAPart) {
    bench_.robot.part = 25.0;
    const auto grasped = run(Kind::grasp);
    ASSERT_TRUE(grasped) << grasped.error().message;
    EXPECT_TRUE(grasped->part_held);
    EXPECT_NEAR(grasped->width, 0.025, 1e-4);
    EXPECT_TRUE(state().part_held);
    EXPECT_FALSE(state().moving);
    ASSERT_TRUE(run(Kind::release));
    EXPECT_FALSE(state().part_held);
}

TEST_F(GripperTest, SeesThatAPartIsLost) {
    bench_.robot.part = 25.0;
    ASSERT_TRUE(run(Kind::grasp));
    bench_.robot.joints[6] = 10.0;
    bench_.run(50);
    EXPECT_FALSE(state().part_held);
}

TEST_F(GripperTest, TellsThatThereIsNoPart) {
    const auto grasped = run(Kind::grasp, {.width = 0.03});
    ASSERT_FALSE(grasped);
    EXPECT_EQ(grasped.error().code, Errc::device_fault);
    EXPECT_THAT(grasped.error().message, HasSubstr("edo gripper: no part found"));
    EXPECT_THAT(grasped.error().message, HasSubstr("26.0 mm"));
}

TEST_F(GripperTest, APartNeedsACurrentIfTheSettingsSaySo) {
    bench_.options.gripper.grasp_current = 0.2;
    bench_.robot.part = 25.0;
    EXPECT_FALSE(run(Kind::grasp));
    ASSERT_TRUE(run(Kind::release));
    bench_.robot.currents[6] = -0.3;
    EXPECT_TRUE(run(Kind::grasp));
}

TEST_F(GripperTest, SendsTheOverrideOfTheSpeed) {
    ASSERT_TRUE(run(Kind::move, {.width = 0.05, .speed = 0.01}));
    EXPECT_EQ(bench_.robot.count(R"("move_command":77,"move_type":74,"ovr":25)"), 1);
}

TEST_F(GripperTest, RefusesWhatItCannotDo) {
    const auto& options = bench_.options.gripper;
    EXPECT_EQ(taskFor(Kind::grasp, {.force = 10.0}, options).error().code, Errc::not_supported);
    EXPECT_TRUE(taskFor(Kind::grasp, {.force = 0.0}, options));
    EXPECT_EQ(taskFor(Kind::move, {}, options).error().code, Errc::invalid_argument);
    EXPECT_EQ(taskFor(Kind::move, {.width = 0.081}, options).error().code, Errc::out_of_range);
    EXPECT_EQ(taskFor(Kind::move, {.width = std::nan("")}, options).error().code,
              Errc::out_of_range);
    EXPECT_EQ(taskFor(Kind::release, {.speed = 1.0}, options).error().code, Errc::out_of_range);
    EXPECT_EQ(taskFor(Kind::release, {.speed = 0.0}, options).error().code, Errc::out_of_range);
    EXPECT_EQ(taskFor(Kind::release, {.width = -0.001}, options).error().code, Errc::out_of_range);
}

TEST_F(GripperTest, MakesATaskOfWhatIsAsked) {
    const auto& options = bench_.options.gripper;
    EXPECT_DOUBLE_EQ(taskFor(Kind::move, {.width = 0.08}, options)->target, 0.08);
    EXPECT_DOUBLE_EQ(taskFor(Kind::move, {.width = 0.0}, options)->target, 0.0);
    EXPECT_DOUBLE_EQ(taskFor(Kind::release, {}, options)->target, 0.08);
    EXPECT_DOUBLE_EQ(taskFor(Kind::grasp, {}, options)->target, 0.0);
    EXPECT_DOUBLE_EQ(taskFor(Kind::grasp, {.width = 0.03}, options)->target, 0.026);
    EXPECT_DOUBLE_EQ(taskFor(Kind::grasp, {.width = 0.001}, options)->target, 0.0);
    EXPECT_EQ(taskFor(Kind::release, {}, options)->override_percent, 100);
    EXPECT_EQ(taskFor(Kind::release, {.speed = 0.04}, options)->override_percent, 100);
    EXPECT_EQ(taskFor(Kind::release, {.speed = 1e-5}, options)->override_percent, 1);
}

TEST_F(GripperTest, NoticesADroppedMotion) {
    bench_.robot.faults.drop_moves = true;
    const auto moved = run(Kind::move, {.width = 0.02});
    ASSERT_FALSE(moved);
    EXPECT_THAT(moved.error().message, HasSubstr("dropped the motion without a word: CALIBRATED"));
}

TEST_F(GripperTest, ToldToGoWhereItIsItIsThere) {
    bench_.robot.faults.drop_moves = true;
    const auto moved = run(Kind::move, {.width = 0.04});
    ASSERT_TRUE(moved) << moved.error().message;
    EXPECT_FALSE(moved->part_held);
}

TEST_F(GripperTest, TellsARejection) {
    bench_.robot.faults.move_feedback = -2;
    const auto moved = run(Kind::move, {.width = 0.02});
    ASSERT_FALSE(moved);
    EXPECT_THAT(moved.error().message, HasSubstr("refused the motion: rejected, code -103"));
}

TEST_F(GripperTest, NamesTheKindOfARejection) {
    for (const auto& [type, kind] : {std::pair(-1, "error"), std::pair(-3, "buffer full")}) {
        bench_.robot.faults.move_feedback = type;
        const auto moved = run(Kind::move, {.width = 0.02});
        ASSERT_FALSE(moved);
        EXPECT_THAT(moved.error().message, HasSubstr(std::string("motion: ") + kind));
    }
}

TEST_F(GripperTest, TellsThatTheRobotGivesAMotionUpOnItsWay) {
    bench_.robot.jaw_speed = 4.0;
    ask(Kind::release);
    bench_.run(300);
    bench_.session.onText(
        R"({"op":"publish","topic":"/machine_movement_ack","msg":{"type":-1,"data":7}})",
        bench_.now, bench_);
    const auto outcome = ended();
    ASSERT_FALSE(outcome);
    EXPECT_EQ(outcome.error().message, "edo gripper: the robot gave the motion up: error, code 7");
}

TEST_F(GripperTest, IsNotTroubledByWhatTheRobotSaysOfOtherMotions) {
    bench_.session.onText(
        R"({"op":"publish","topic":"/machine_movement_ack","msg":{"type":-1,"data":7}})",
        bench_.now, bench_);
    EXPECT_TRUE(run(Kind::release));
}

TEST_F(GripperTest, GraspsAPartAlthoughTheRobotBelievesThatTheJawsMoveOn) {
    bench_.robot.part = 25.0;
    bench_.robot.faults.believes_in_jaws = true;
    const auto grasped = run(Kind::grasp);
    ASSERT_TRUE(grasped) << grasped.error().message;
    EXPECT_TRUE(grasped->part_held);
    EXPECT_EQ(bench_.robot.count("\"move_command\":67"), 1) << "it must not wait for them";
    bench_.robot.part = -1.0;
    bench_.robot.faults.believes_in_jaws = false;
    EXPECT_TRUE(run(Kind::release));
}

TEST_F(GripperTest, StopBeforeTheArmGaveControlBackMovesNothing) {
    const auto source = bench_.attach(0.001, 20);
    ASSERT_TRUE(bench_.runUntil([&] { return !source->ends.empty(); }));
    ask(Kind::release);
    bench_.session.gripperSlot().stop();
    const auto outcome = ended();
    ASSERT_FALSE(outcome);
    EXPECT_EQ(outcome.error().code, Errc::cancelled);
    EXPECT_EQ(outcome.error().message, "edo gripper: stopped");
    EXPECT_EQ(bench_.robot.count("/bridge_move"), 1) << "advertised";
}

TEST_F(GripperTest, StopCancelsOnce) {
    bench_.robot.jaw_speed = 4.0;
    ask(Kind::release);
    bench_.run(300);
    bench_.session.gripperSlot().stop();
    bench_.run(50);
    bench_.session.gripperSlot().stop();
    EXPECT_EQ(ended().error().code, Errc::cancelled);
    EXPECT_EQ(bench_.robot.count("\"move_command\":67"), 1);
}

TEST_F(GripperTest, TellsThatTheJawsDoNotStop) {
    bench_.robot.jaw_speed = 4.0;
    bench_.robot.faults.drop_cancels = true;
    ask(Kind::release);
    bench_.run(300);
    bench_.session.gripperSlot().stop();
    bench_.run(1900);
    EXPECT_FALSE(outcome_);
    const auto outcome = ended();
    ASSERT_FALSE(outcome);
    EXPECT_EQ(outcome.error().code, Errc::device_fault);
    EXPECT_THAT(outcome.error().message, HasSubstr("edo gripper: does not stop: MOVE, jaws at "));
}

TEST_F(GripperTest, TakesAPartOnlyForWhatIsWiderThanTheShortfall) {
    bench_.robot.part = 27.9;  // asked for 30 mm, the jaws would go on to 26 mm
    EXPECT_FALSE(run(Kind::grasp, {.width = 0.03}));
    ASSERT_TRUE(run(Kind::release));
    bench_.robot.part = 28.1;
    EXPECT_TRUE(run(Kind::grasp, {.width = 0.03}));
}

TEST_F(GripperTest, JudgesACurrentByItsSizeAndNoneIfTheRobotTellsNone) {
    auto options = testing::benchOptions();
    options.gripper.grasp_current = 0.2;
    GripperDrive drive(options);
    drive.onJoint({.position = 0.025, .current = std::nan("")}, bench_.now);
    drive.start({Kind::grasp, 0.0, 100}, {}, bench_.now, bench_);
    const auto outcome = [&] {
        bench_.now += std::chrono::seconds(1);
        static_cast<void>(drive.tick({MachineState::move, 0}, bench_.now, bench_));
        bench_.now += std::chrono::seconds(1);
        return drive.tick({MachineState::calibrated, 0}, bench_.now, bench_);
    }();
    ASSERT_TRUE(outcome);
    EXPECT_FALSE(*outcome);
}

TEST_F(GripperTest, SilentJointsEndTheMotionAsALoss) {
    bench_.robot.jaw_speed = 4.0;
    ask(Kind::release);
    bench_.run(300);
    bench_.robot.faults.mute_joints = true;
    const auto outcome = ended();
    ASSERT_FALSE(outcome);
    EXPECT_EQ(outcome.error().code, Errc::connection_lost);
    EXPECT_THAT(outcome.error().message, HasSubstr("no joint states"));
}

TEST_F(GripperTest, StopsAMotion) {
    bench_.robot.jaw_speed = 4.0;
    ask(Kind::release);
    bench_.run(300);
    bench_.session.gripperSlot().stop();
    const auto outcome = ended();
    ASSERT_FALSE(outcome);
    EXPECT_EQ(outcome.error().code, Errc::cancelled);
    EXPECT_EQ(bench_.robot.count("\"move_command\":67"), 1);
    EXPECT_LT(bench_.robot.joints[6], 45.0);
}

TEST_F(GripperTest, JawsThatNeverArriveTimeOut) {
    bench_.robot.jaw_speed = 2.0;
    bench_.options.gripper.timeout = std::chrono::seconds(1);
    const auto moved = run(Kind::move, {.width = 0.02});
    ASSERT_FALSE(moved);
    EXPECT_EQ(moved.error().code, Errc::timeout);
    EXPECT_EQ(bench_.robot.count("\"move_command\":67"), 1);
}

TEST_F(GripperTest, ABlockedReleaseIsAFault) {
    bench_.robot.jaw_speed = 20.0;
    ask(Kind::release);
    bench_.run(500);
    bench_.robot.jaw_speed = 0.0;  // the robot goes on believing
    const auto outcome = ended();
    ASSERT_FALSE(outcome);
    EXPECT_THAT(outcome.error().message, HasSubstr("blocked: the jaws opened to"));
}

TEST_F(GripperTest, OneMotionAtATime) {
    ask(Kind::release);
    const auto second = bench_.session.gripperSlot().post({}, [](auto) {});
    EXPECT_EQ(second.error().code, Errc::resource_unavailable);
    EXPECT_TRUE(ended());
}

TEST_F(GripperTest, WaitsUntilTheArmGaveControlBack) {
    const auto source = bench_.attach(0.001, 20);
    ASSERT_TRUE(bench_.runUntil([&] { return !source->ends.empty(); }));
    ASSERT_TRUE(bench_.robot.control_taken);
    const auto released = run(Kind::release);
    ASSERT_TRUE(released) << released.error().message;
    EXPECT_FALSE(bench_.robot.control_taken);
    EXPECT_NEAR(bench_.robot.joints[0], 20 * 0.001 / std::numbers::pi * 180.0, 1e-3);
}

TEST_F(GripperTest, ABrakeEndsTheMotion) {
    bench_.robot.jaw_speed = 4.0;
    ask(Kind::release);
    bench_.run(300);
    bench_.robot.brake(1U << 6U);
    const auto outcome = ended();
    ASSERT_FALSE(outcome);
    EXPECT_EQ(outcome.error().code, Errc::device_fault);
    EXPECT_THAT(outcome.error().message, HasSubstr("BRAKED (brake active)"));
}

TEST_F(GripperTest, TheLossOfTheLinkEndsTheMotion) {
    ask(Kind::release);
    bench_.run(50);
    bench_.session.linkDown("gone");
    bench_.session.gripperSlot().dispatch();
    ASSERT_TRUE(outcome_);
    EXPECT_EQ(outcome_->error().code, Errc::connection_lost);
}

}  // namespace
}  // namespace metier::edo_driver
