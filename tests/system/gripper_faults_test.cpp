// A gripper on its maker's wire: parts that are held, missed, lost or of another width, its own
// faults, and its cable.
#include <gmock/gmock.h>

#include "metier_program.hpp"
#include "running_cell.hpp"

namespace metier::system_tests {
namespace {

using namespace std::chrono_literals;
using skill::Reason;
using skill::State;
using ::testing::HasSubstr;

constexpr auto kNoticed = 2s;

/// A gripper on its maker's wire.
class GripperOnItsWire : public ::testing::Test {
protected:
    void SetUp() override { resetAll(); }

    /// Makes both skills ready: Reset acknowledges the gripper's fault and homes it.
    void resetAll() {
        const auto deadline = inAMinute();
        for (auto* skill : {&grasp_, &release_}) {
            while (*skill->state() != State::ready && !skill->reset()) {
                ASSERT_LT(std::chrono::steady_clock::now(), deadline) << skill->reasonText();
            }
        }
    }

    RunningCell cell_{deviceCell("wsg50")};
    std::unique_ptr<opcua::Client> client_ = connectTo(cell_.url("gripper"));
    skill_client::SkillHandle grasp_ = openSkill(*client_, "GraspGripperSkill");
    skill_client::SkillHandle release_ = openSkill(*client_, "ReleaseGripperSkill");
};

TEST_F(GripperOnItsWire, HoldsAPartAndLetsItGo) {
    cell_.inject("controller", "part", "30");
    const auto held = grasp_.run({{"Force", 40.0}}, inAMinute());
    ASSERT_TRUE(held) << held.error().message;
    EXPECT_EQ(held->at("PartHeld"), skill::Value(true));
    EXPECT_NEAR(std::get<double>(held->at("WidthReached")), 0.03, 2e-3);
    const auto released = release_.run({}, inAMinute());
    ASSERT_TRUE(released) << released.error().message;
    EXPECT_EQ(released->at("PartHeld"), skill::Value(false));
}

TEST_F(GripperOnItsWire, SaysThatThereIsNoPart) {
    const auto missed = grasp_.run({}, inAMinute());
    ASSERT_FALSE(missed);
    EXPECT_THAT(missed.error().message, HasSubstr("no part"));
    EXPECT_EQ(*grasp_.state(), State::halted);
    resetAll();
    EXPECT_TRUE(release_.run({}, inAMinute()));
}

TEST_F(GripperOnItsWire, IsHaltedByACutCableAndComesBack) {
    cell_.inject("controller", "cut-link");
    ASSERT_TRUE(grasp_.awaitState(State::halted, std::chrono::steady_clock::now() + kNoticed));
    cell_.inject("controller", "restore-link");
    resetAll();
    EXPECT_TRUE(release_.run({}, inAMinute()));
}

}  // namespace
}  // namespace metier::system_tests
