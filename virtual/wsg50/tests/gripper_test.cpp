#include "gripper.hpp"

#include <gmock/gmock.h>

#include <limits>
#include <utility>
#include <vector>

namespace metier::virtual_wsg50 {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::Pair;

/// A gripper without a wire; time is moved by hand.
class GripperOnTable : public ::testing::Test {
protected:
    void run(double seconds) {
        for (double time = 0.0; time < seconds; time += 0.002) {
            gripper_.step(0.002, obstacles_);
        }
    }
    void reference() {
        ASSERT_EQ(gripper_.home(HomingDirection::standard), Status::pending);
        run(2.0);
        ASSERT_TRUE(gripper_.referenced());
        ended_.clear();
    }
    /// Grasps a part of 31 mm.
    void hold() {
        obstacles_.part = 0.031;
        ASSERT_EQ(gripper_.grasp(0.030, 0.2), Status::pending);
        run(1.0);
        ASSERT_EQ(gripper_.graspingState(), GraspingState::holding);
        ended_.clear();
    }
    bool has(std::uint32_t bit) const { return (gripper_.systemState() & bit) != 0; }

    std::vector<std::pair<Command, Status>> ended_;  // motions with their ends
    Obstacles obstacles_;
    Gripper gripper_{
        {}, [this](Command command, Status status) { ended_.emplace_back(command, status); }};
};

TEST_F(GripperOnTable, HomesToTheEndThatItsCommandNames) {
    gripper_.home(HomingDirection::negative);
    run(2.0);
    EXPECT_DOUBLE_EQ(gripper_.width(), 0.0);
    gripper_.home(HomingDirection::positive);
    EXPECT_FALSE(gripper_.referenced()) << "until it is there";
    run(2.0);
    EXPECT_DOUBLE_EQ(gripper_.width(), 0.110);
    EXPECT_THAT(ended_, ElementsAre(Pair(Command::home, Status::success),
                                    Pair(Command::home, Status::success)));
}

TEST_F(GripperOnTable, HasNoReferenceAfterAHomingThatWasBlocked) {
    reference();
    obstacles_.block = 0.05;
    gripper_.home(HomingDirection::negative);
    run(2.0);
    EXPECT_THAT(ended_, ElementsAre(Pair(Command::home, Status::axis_blocked)));
    EXPECT_FALSE(gripper_.referenced());
    EXPECT_EQ(gripper_.release(0.1, 0.1), Status::not_initialised);
}

TEST_F(GripperOnTable, HasNoReferenceAfterAHomingThatWasStopped) {
    reference();
    gripper_.home(HomingDirection::negative);
    run(0.1);
    gripper_.stop();
    EXPECT_THAT(ended_, ElementsAre(Pair(Command::home, Status::command_aborted)));
    EXPECT_FALSE(gripper_.referenced());
}

TEST_F(GripperOnTable, BrakesWhereItIsStopped) {
    reference();
    gripper_.prePosition(0.0, 0.4, WhenBlocked::stop);
    run(0.2);
    const double width = gripper_.width();
    const double way = gripper_.velocity() * gripper_.velocity() / 2.0 / gripper_.acceleration();
    gripper_.stop();
    run(1.0);
    EXPECT_NEAR(gripper_.width(), width - way, 0.001);
    EXPECT_GT(way, 0.01);
}

TEST_F(GripperOnTable, GraspsFromInsideWhenItIsNarrowerThanThePart) {
    reference();
    gripper_.prePosition(0.020, 0.4, WhenBlocked::stop);
    run(1.0);
    obstacles_.block = 0.050;
    gripper_.grasp(0.050, 0.1);
    run(1.0);
    EXPECT_EQ(gripper_.graspingState(), GraspingState::holding);
    EXPECT_TRUE(has(system_bit::kBlockedPlus));
    EXPECT_FALSE(has(system_bit::kBlockedMinus));
    EXPECT_EQ(gripper_.force(), 80.0);
}

TEST_F(GripperOnTable, SearchesAPartWithinItsSoftLimitsOnly) {
    reference();
    ASSERT_EQ(gripper_.setSoftLimits({0.029, 0.110}), Status::success);
    gripper_.grasp(0.030, 0.2);
    run(1.0);
    EXPECT_THAT(ended_, ElementsAre(Pair(Command::grasp, Status::command_failed)));
    EXPECT_NEAR(gripper_.width(), 0.029, 1e-9) << "not 27 mm";
    EXPECT_TRUE(has(system_bit::kSoftLimitMinus));
    EXPECT_FALSE(has(system_bit::kSoftLimitPlus));
}

TEST_F(GripperOnTable, HoldsItsPartThroughAStopAndAFastStop) {
    reference();
    hold();
    gripper_.stop();
    run(0.1);
    EXPECT_EQ(gripper_.graspingState(), GraspingState::holding);
    gripper_.fastStop();
    run(0.1);
    EXPECT_EQ(gripper_.graspingState(), GraspingState::holding);
    EXPECT_EQ(gripper_.force(), 80.0);
    EXPECT_THAT(ended_, IsEmpty()) << "no motion was under way";
    EXPECT_EQ(gripper_.abortedSinceReset(), 0);
}

TEST_F(GripperOnTable, EndsItsMotionWhenItBecomesTooHot) {
    reference();
    gripper_.prePosition(0.020, 0.1, WhenBlocked::stop);
    run(0.2);
    gripper_.setTemperatureFault(true);
    EXPECT_THAT(ended_, ElementsAre(Pair(Command::pre_position, Status::command_aborted)));
    const double width = gripper_.width();
    run(0.2);
    EXPECT_EQ(gripper_.width(), width);
    EXPECT_EQ(gripper_.graspingState(), GraspingState::error);
    EXPECT_GT(gripper_.temperature(), 90.0);
    gripper_.setTemperatureFault(false);
    EXPECT_TRUE(gripper_.fault()) << "until it is acknowledged";
    gripper_.acknowledge();
    EXPECT_FALSE(gripper_.fault());
    EXPECT_EQ(gripper_.graspingState(), GraspingState::idle);
}

TEST_F(GripperOnTable, TakesSettingsUpToTheirLimits) {
    EXPECT_EQ(gripper_.setAcceleration(0.1), Status::success);
    EXPECT_EQ(gripper_.setAcceleration(5.0), Status::success);
    EXPECT_EQ(gripper_.setForceLimit(5.0), Status::success);
    EXPECT_EQ(gripper_.setForceLimit(80.0), Status::success);
    EXPECT_EQ(gripper_.setSoftLimits({0.0, 0.110}), Status::success);
    const double none = std::numeric_limits<double>::quiet_NaN();
    for (const double value : {0.09, 5.01, none}) {
        EXPECT_EQ(gripper_.setAcceleration(value), Status::range_error) << value;
    }
    for (const double value : {4.9, 80.1, none}) {
        EXPECT_EQ(gripper_.setForceLimit(value), Status::range_error) << value;
    }
    for (const SoftLimits& limits :
         {SoftLimits{-0.001, 0.1}, {0.0, 0.111}, {0.05, 0.05}, {none, 0.1}, {0.0, none}}) {
        EXPECT_EQ(gripper_.setSoftLimits(limits), Status::range_error)
            << limits.minus << ' ' << limits.plus;
    }
    EXPECT_EQ(gripper_.acceleration(), 5.0);
    EXPECT_EQ(gripper_.forceLimit(), 80.0);
    EXPECT_EQ(gripper_.softLimits().plus, 0.110);
}

}  // namespace
}  // namespace metier::virtual_wsg50
