// A motion of the cabinet's planner, with the cabinet and the time moved by hand.
#include <gmock/gmock.h>

#include "controller_planned_run.hpp"
#include "hand_moved.hpp"
#include "metier/motion/frame.hpp"

namespace metier::iiwa_driver {
namespace {

using Cause = RunEnd::Cause;
using ::testing::ElementsAre;

class ControllerPlannedRunTest : public ::testing::Test {
protected:
    /// Begins, and sends all settings that are needed.
    void begin(const device::ControllerPlannedMotion& motion) {
        run_.begin({motion, motion::Pose::identity(), 10.0}, state_, settings_);
        while (run_.hurried()) {
            ASSERT_FALSE(step());
        }
        sent_.clear();
    }
    void begin() { begin(ArmBench::toJoints(0.5)); }

    /// \return whether the motion is over
    bool step(double seconds = 0.01) {
        sent_.push_back(run_.command());
        return run_.take(sent_.back(), state_, seconds, settings_);
    }
    bool passes(double seconds) {
        bool over = false;
        for (double time = 0.0; time < seconds - 1e-9 && !over; time += 0.01) {
            over = step();
        }
        return over;
    }
    void moves(double first_axis, double speed = 0.5) {
        state_.active = true;
        state_.position[0] = first_axis;
        state_.velocity[0] = speed;
        ASSERT_FALSE(step());
    }
    void rests(double first_axis) {
        state_.active = false;
        state_.position[0] = first_axis;
        state_.velocity[0] = 0.0;
    }
    Cause cause() const { return run_.end().cause; }

    CabinetState state_ = readyCabinet();
    CabinetSettings settings_;
    ControllerPlannedRun run_;
    std::vector<Command> sent_;
};

TEST_F(ControllerPlannedRunTest, MayTakeThreeTenthsOfASecondToBegin) {
    begin();
    EXPECT_FALSE(passes(0.29));
    EXPECT_TRUE(passes(0.02));
    EXPECT_EQ(cause(), Cause::off_target);
    EXPECT_NEAR(run_.end().miss.distance, 0.5, 1e-9);
}

TEST_F(ControllerPlannedRunTest, IsDoneWhereItStandsAtItsTarget) {
    begin();
    moves(0.2);
    rests(0.4979);
    state_.velocity[0] = 0.1;
    EXPECT_FALSE(passes(0.05)) << "it still moves";
    state_.velocity[0] = 0.0;
    EXPECT_FALSE(step()) << "2 mrad and a little";
    state_.position[0] = 0.4981;
    EXPECT_TRUE(step());
    EXPECT_EQ(cause(), Cause::at_target);
    EXPECT_EQ(run_.end().outcome.end, device::MotionOutcome::End::at_target);
}

TEST_F(ControllerPlannedRunTest, MaySettleForATenthOfASecond) {
    begin();
    moves(0.2);
    rests(0.3);
    EXPECT_FALSE(passes(0.1));
    EXPECT_TRUE(passes(0.02));
    EXPECT_EQ(cause(), Cause::off_target);
}

TEST_F(ControllerPlannedRunTest, ThatEndsElsewhereBecauseTheCabinetIsNotReadySaysSo) {
    begin();
    moves(0.2);
    rests(0.3);
    state_.ready = false;
    EXPECT_TRUE(passes(0.2));
    EXPECT_EQ(cause(), Cause::not_ready);
}

TEST_F(ControllerPlannedRunTest, ThatIsRefusedNamesTheCommandAndWhetherTheCabinetIsReady) {
    for (const bool ready : {true, false}) {
        run_.begin({ArmBench::toJoints(0.5), motion::Pose::identity(), 10.0}, state_, settings_);
        state_.executed = false;
        state_.ready = ready;
        EXPECT_TRUE(step());
        EXPECT_EQ(cause(), ready ? Cause::refused : Cause::not_ready);
        EXPECT_EQ(run_.end().command.code, Code::interface);
        state_.executed = true;
    }
}

TEST_F(ControllerPlannedRunTest, IsCancelledAgainAfterHalfASecond) {
    begin();
    moves(0.2);
    sent_.clear();
    run_.stop(Cause::stopped);
    EXPECT_FALSE(passes(0.55));
    auto codes = codesOf(sent_);
    EXPECT_EQ(codes.front(), 101);
    EXPECT_EQ(std::count(codes.begin(), codes.end(), 101), 2);
    EXPECT_EQ(codes[51], 101);
    EXPECT_FALSE(passes(3.4));
    EXPECT_TRUE(passes(0.1)) << "4 s";
    EXPECT_EQ(cause(), Cause::stalled);
}

TEST_F(ControllerPlannedRunTest, IsStoppedOnceItStandsAfterTheCancel) {
    begin();
    moves(0.2);
    run_.stop(Cause::stopped);
    rests(0.3);
    state_.active = true;
    EXPECT_FALSE(step()) << "the cabinet still has a motion";
    state_.active = false;
    state_.velocity[0] = 0.1;
    EXPECT_FALSE(step());
    state_.velocity[0] = 0.0;
    EXPECT_TRUE(step());
    EXPECT_EQ(cause(), Cause::stopped);
    EXPECT_EQ(run_.end().outcome.end, device::MotionOutcome::End::stopped);
}

TEST_F(ControllerPlannedRunTest, ThatStandsAlreadyIsCancelledAllTheSame) {
    begin();
    run_.stop(Cause::stopped);
    EXPECT_TRUE(step());
    EXPECT_THAT(codesOf(sent_), ElementsAre(101)) << "a motion may be on its way";
}

TEST_F(ControllerPlannedRunTest, ThatIsStoppedAtItsTargetHasArrived) {
    begin();
    moves(0.2);
    run_.stop(Cause::stopped);
    run_.stop(Cause::not_ready);
    rests(0.5);
    EXPECT_TRUE(step());
    EXPECT_EQ(cause(), Cause::at_target);
}

TEST_F(ControllerPlannedRunTest, ThatIsStoppedForSafetyHasNotArrived) {
    begin();
    moves(0.2);
    run_.stop(Cause::not_ready);
    run_.stop(Cause::stopped);
    rests(0.5);
    EXPECT_TRUE(step());
    EXPECT_EQ(cause(), Cause::not_ready) << "the first reason counts";
}

TEST_F(ControllerPlannedRunTest, ANewMotionThatWasStoppedBeforeItWasToldMovesNothing) {
    run_.begin({ArmBench::toJoints(0.5), motion::Pose::identity(), 10.0}, state_, settings_);
    run_.stop(Cause::stopped);
    EXPECT_TRUE(step());
    EXPECT_THAT(codesOf(sent_), ElementsAre(101));
    EXPECT_EQ(cause(), Cause::stopped);
}

TEST_F(ControllerPlannedRunTest, EndsWithAForceOfItsOwn) {
    begin();
    moves(0.2);
    rests(0.3);
    state_.force_condition_met = true;
    state_.force = {1.0, -30.0, 2.0};
    EXPECT_TRUE(step());
    EXPECT_EQ(cause(), Cause::force);
    EXPECT_EQ(run_.end().outcome.end, device::MotionOutcome::End::force);
    EXPECT_EQ(run_.end().outcome.force, state_.force);
    EXPECT_EQ(run_.end().outcome.largest_force, (std::array{1.0, 30.0, 2.0}));
}

TEST_F(ControllerPlannedRunTest, TakesNoForceOfTheMotionBeforeForItsOwn) {
    state_.force_condition_met = true;
    begin();
    EXPECT_FALSE(passes(0.29)) << "it has not begun";
    state_.active = true;
    state_.force_condition_met = false;
    state_.velocity[0] = 0.5;
    EXPECT_FALSE(step());
    rests(0.5);
    EXPECT_TRUE(step());
    EXPECT_EQ(cause(), Cause::at_target);
}

TEST_F(ControllerPlannedRunTest, IsInContactIfTheFlagStillStandsLongAfterItWasAccepted) {
    state_.force_condition_met = true;
    begin();
    EXPECT_TRUE(passes(0.35));
    EXPECT_EQ(cause(), Cause::force);
}

TEST_F(ControllerPlannedRunTest, KeepsTheLargestForceAndTheErrorOfItsOwnTime) {
    state_.last_error = -11;
    begin();
    state_.force = {-5.0, 1.0, 0.0};
    moves(0.2);
    EXPECT_EQ(run_.end().error, 0) << "an old one";
    state_.last_error = -14;
    state_.force = {2.0, -3.0, 0.5};
    moves(0.3);
    EXPECT_EQ(run_.end().error, -14);
    EXPECT_EQ(run_.end().outcome.largest_force, (std::array{5.0, 3.0, 0.5}));
}

TEST_F(ControllerPlannedRunTest, IsStalledWithoutProgressForThreeSeconds) {
    begin();
    moves(0.2);
    EXPECT_FALSE(passes(2.9));
    EXPECT_EQ(sent_.back().code, Code::state);
    state_.position[4] += 2e-4;
    EXPECT_FALSE(passes(3.0)) << "any axis counts";
    EXPECT_EQ(sent_.back().code, Code::state);
    EXPECT_FALSE(passes(0.05));
    EXPECT_EQ(sent_.back().code, Code::state) << "cancelled once in half a second";
    EXPECT_THAT(codesOf(sent_), ::testing::Contains(101));
    rests(0.2);
    EXPECT_TRUE(step());
    EXPECT_EQ(cause(), Cause::stalled);
}

class RunToAPose : public ControllerPlannedRunTest {
protected:
    RunToAPose() {
        motion_.target_flange = Frame{0.5, 0.1, 0.6, 0.0, 0.0, 0.0};
        state_.pose = *motion_.target_flange;
        state_.pose.x += 0.2;
        begin(motion_);
        moves(0.1);
        rests(0.2);
        state_.pose = *motion_.target_flange;
    }

    device::ControllerPlannedMotion motion_;
};

TEST_F(RunToAPose, IsDoneWithinAMillimetre) {
    state_.pose.y += 0.0011;
    EXPECT_FALSE(step());
    EXPECT_EQ(run_.end().miss.quantity, Miss::Quantity::position);
    EXPECT_NEAR(run_.end().miss.distance, 0.0011, 1e-9);
    state_.pose.y -= 0.0002;
    EXPECT_TRUE(step());
    EXPECT_EQ(cause(), Cause::at_target);
}

TEST_F(RunToAPose, IsDoneWithinFiveMilliradians) {
    state_.pose.c += 0.0051;
    EXPECT_FALSE(step());
    EXPECT_EQ(run_.end().miss.quantity, Miss::Quantity::rotation);
    EXPECT_NEAR(run_.end().miss.distance, 0.0051, 1e-6);
    state_.pose.c -= 0.0002;
    EXPECT_TRUE(step());
    EXPECT_EQ(cause(), Cause::at_target);
}

}  // namespace
}  // namespace metier::iiwa_driver
