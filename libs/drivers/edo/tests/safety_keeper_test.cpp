#include "safety_keeper.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "session_bench.hpp"

namespace metier::edo_driver {
namespace {

using namespace std::chrono_literals;
using device::SafetyState;
using ::testing::HasSubstr;

constexpr MachineState kReady{MachineState::calibrated, 0};

/// A keeper whose robot and whose time are moved by hand.
class SafetyKeeperTest : public ::testing::Test {
protected:
    SafetyState state() const { return core_.safety().state; }
    std::string text() const { return core_.safety().text; }
    void robotIsReady() {
        keeper_.linkFound(now_);
        keeper_.onMachineState(kReady, now_);
        keeper_.onJointStates(7, now_);
        ASSERT_EQ(state(), SafetyState::normal) << text();
    }

    EdoOptions options_ = testing::benchOptions();
    device::ArmCore core_{{options_.name, options_.axis_names, EdoOptions::kCycle}};
    SafetyKeeper keeper_{options_, core_};
    SteadyTime now_{1000s};
};

TEST_F(SafetyKeeperTest, TellsEveryChangeAtOnce) {
    keeper_.linkLost("refused");
    EXPECT_EQ(text(), "edo: refused");
    keeper_.linkFound(now_);
    EXPECT_EQ(text(), "edo: no machine state yet");
    keeper_.unusable("an unknown version");
    EXPECT_EQ(state(), SafetyState::fault);
    EXPECT_EQ(text(), "edo: an unknown version");
    keeper_.linkLost("gone");
    EXPECT_EQ(state(), SafetyState::disconnected);
    robotIsReady();
    EXPECT_EQ(text(), "") << "unusable only while the link lasts";
    keeper_.onMachineState({MachineState::braked, 0}, now_);
    EXPECT_EQ(state(), SafetyState::protective_stop);
    EXPECT_FALSE(keeper_.robotAllowsMotion());
    keeper_.onMachineState(kReady, now_);
    EXPECT_EQ(state(), SafetyState::normal);
    EXPECT_TRUE(keeper_.robotAllowsMotion());
    keeper_.onJointStates(6, now_);
    EXPECT_EQ(state(), SafetyState::fault);
}

TEST_F(SafetyKeeperTest, KeepsItsFirstFaultUntilItIsCleared) {
    robotIsReady();
    keeper_.fault("first", SafetyKeeper::Limit::violated);
    keeper_.fault("second");
    EXPECT_EQ(state(), SafetyState::protective_stop);
    EXPECT_EQ(text(), "edo: first");
    EXPECT_TRUE(core_.safety().limit_violated);
    keeper_.clearFault();
    EXPECT_EQ(state(), SafetyState::normal);
    EXPECT_FALSE(keeper_.hasFault());
    keeper_.fault("third");
    EXPECT_EQ(text(), "edo: third");
    EXPECT_FALSE(core_.safety().limit_violated);
}

TEST_F(SafetyKeeperTest, NoticesSilenceAfterItsTimes) {
    robotIsReady();
    keeper_.tick(now_ + 100ms);
    EXPECT_EQ(state(), SafetyState::normal);
    keeper_.tick(now_ + 101ms);
    EXPECT_EQ(state(), SafetyState::disconnected);
    EXPECT_EQ(text(), "edo: no joint states for 100 ms");
    EXPECT_TRUE(keeper_.jointsSilent());
    keeper_.onJointStates(7, now_ + 1000ms);
    EXPECT_EQ(state(), SafetyState::normal) << text();
    keeper_.tick(now_ + 1000ms);
    EXPECT_EQ(state(), SafetyState::normal) << text();
    keeper_.onJointStates(7, now_ + 1001ms);
    keeper_.tick(now_ + 1001ms);
    EXPECT_EQ(text(), "edo: no machine state for 1000 ms");
    keeper_.onMachineState(kReady, now_ + 1050ms);
    EXPECT_EQ(state(), SafetyState::normal) << "the same state as before";
}

TEST_F(SafetyKeeperTest, ExpectsNoJointsBeforeTheyAreDiscovered) {
    keeper_.linkFound(now_);
    keeper_.onMachineState({MachineState::init, 0}, now_);
    keeper_.tick(now_ + 500ms);
    EXPECT_EQ(state(), SafetyState::protective_stop) << text();
    keeper_.onMachineState({MachineState::command, 0}, now_ + 500ms);
    keeper_.tick(now_ + 500ms);
    EXPECT_EQ(state(), SafetyState::protective_stop) << text();
    keeper_.onMachineState(kReady, now_ + 500ms);
    EXPECT_EQ(text(), "edo: no joint states for 100 ms");
}

TEST_F(SafetyKeeperTest, TellsTheGravest) {
    keeper_.fault("its own");
    EXPECT_EQ(state(), SafetyState::disconnected);
    keeper_.linkFound(now_);
    keeper_.onJointStates(6, now_);
    keeper_.onMachineState({MachineState::braked, 0}, now_);
    EXPECT_THAT(text(), HasSubstr("BRAKED"));
    keeper_.onMachineState(kReady, now_);
    EXPECT_THAT(text(), HasSubstr("6 joints"));
    keeper_.onJointStates(7, now_);
    EXPECT_EQ(text(), "edo: its own");
}

}  // namespace
}  // namespace metier::edo_driver
