#include <gmock/gmock.h>

#include "gripper_bench.hpp"

namespace metier::robot_skills {
namespace {

using namespace std::chrono_literals;
using device::SafetyState;
using skill::Reason;
using skill::State;
using ::testing::HasSubstr;

/// Jaws that hold a part, and the skill that watches it.
class HeldPart : public ::testing::Test {
protected:
    HeldPart() { gripper.setPartHeld(true); }

    Result<void> start() {
        auto started = hold.start(caller);
        executor->run();
        return started;
    }
    void pass(std::chrono::milliseconds time) { executor->advance(time); }

    const skill::Caller caller{"session", "client", "user"};
    HandDrivenGripper gripper;
    std::shared_ptr<skill::testing::ManualExecutor> executor =
        std::make_shared<skill::testing::ManualExecutor>();
    skill::Program hold{{}, makeHoldSkill(gripper, executor), executor, executor->clock()};
};

TEST_F(HeldPart, IsWatchedUntilItIsLost) {
    ASSERT_TRUE(start());
    pass(10s);
    EXPECT_EQ(hold.state(), State::running);
    gripper.setPartHeld(false);
    pass(20ms);
    EXPECT_EQ(hold.state(), State::halted);
    EXPECT_EQ(hold.reason(), Reason::error);
    EXPECT_EQ(hold.reasonText(), "tool holds no part: the jaws are at 0.0 mm");
}

TEST_F(HeldPart, MustBeHeldToBegin) {
    gripper.setPartHeld(false);
    const auto started = start();
    ASSERT_FALSE(started);
    EXPECT_THAT(started.error().message, HasSubstr("tool holds no part"));
    EXPECT_EQ(hold.state(), State::ready);
}

TEST_F(HeldPart, IsNotWatchedWhileSuspendedAndMustBeHeldToResume) {
    ASSERT_TRUE(start());
    ASSERT_TRUE(hold.suspend(caller));
    executor->run();
    ASSERT_EQ(hold.state(), State::suspended);
    gripper.setPartHeld(false);
    pass(1s);
    EXPECT_EQ(hold.state(), State::suspended);
    EXPECT_FALSE(hold.resume(caller));
    gripper.setPartHeld(true);
    ASSERT_TRUE(hold.resume(caller));
    pass(1s);
    EXPECT_EQ(hold.state(), State::running);
}

TEST_F(HeldPart, IsWatchedUntilHaltAndTheJawsAreLeftAlone) {
    ASSERT_TRUE(start());
    ASSERT_TRUE(hold.halt(caller));
    executor->run();
    EXPECT_EQ(hold.state(), State::halted);
    EXPECT_EQ(gripper.stops, 0);
    ASSERT_TRUE(hold.reset(caller));
    EXPECT_EQ(gripper.resets, 0);
}

TEST_F(HeldPart, OfAGripperThatIsGoneIsADeviceLost) {
    ASSERT_TRUE(start());
    gripper.setSafety({SafetyState::disconnected, "tool: the cable was pulled", false});
    pass(20ms);
    EXPECT_EQ(hold.state(), State::halted);
    EXPECT_EQ(hold.reason(), Reason::device_lost);
    EXPECT_THAT(hold.reasonText(), HasSubstr("the cable was pulled"));
}

}  // namespace
}  // namespace metier::robot_skills
