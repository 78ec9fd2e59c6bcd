#include <gmock/gmock.h>

#include "lab.hpp"

namespace metier::server::testing {
namespace {

using skill::State;
using ::testing::HasSubstr;
using ::testing::IsSupersetOf;

class GripperOfACell : public Lab {
protected:
    static cell::GripperServer gripper() {
        cell::GripperServer gripper;
        gripper.driver.type = "gripper";
        gripper.driver.controller = "10.0.0.7";
        gripper.nodeset = "wsg50";
        gripper.skills = {"GraspGripperSkill", "ReleaseGripperSkill", "MoveGripperSkill",
                          "HoldGripperSkill"};
        return gripper;
    }
};

TEST_F(GripperOfACell, OffersTheSkillsOfItsNodeSetAndGraspsByThem) {
    const auto server = serve(config("hand", gripper()));
    ASSERT_TRUE(server);
    EXPECT_EQ(lastRequest().name, "hand");
    EXPECT_EQ(lastRequest().address, "10.0.0.7");
    EXPECT_EQ(lastRequest().model, nullptr);
    const auto client = connect(*server);
    EXPECT_THAT(skillsOf(*client), IsSupersetOf({"GraspGripperSkill", "ReleaseGripperSkill"}));
    auto grasp = open(*client, "GraspGripperSkill");
    const auto grasped = grasp.run(skill::ValueMap{}, inAMinute());
    ASSERT_TRUE(grasped) << grasped.error().message;
    EXPECT_TRUE(lastGripper()->state().part_held);
}

TEST_F(GripperOfACell, HaltsItsSkillsWhenItIsLost) {
    const auto server = serve(config("hand", gripper()));
    ASSERT_TRUE(server);
    const auto client = connect(*server);
    auto grasp = open(*client, "GraspGripperSkill");
    ASSERT_EQ(grasp.state().value(), State::ready);
    lastGripper()->become(device::SafetyState::disconnected, "hand: no answer");
    ASSERT_TRUE(grasp.awaitState(State::halted, inAMinute()));
    EXPECT_THAT(grasp.reasonText(), HasSubstr("hand: no answer"));
}

TEST_F(GripperOfACell, IsRefusedWithAnotherKindOfDevice) {
    auto hand = gripper();
    hand.driver.type = "sensor";
    EXPECT_EQ(refusal(config("hand", hand)).message,
              "hand: the driver \"sensor\" is not one of a gripper");
}

TEST_F(GripperOfACell, IsRefusedWithoutItsNodeSet) {
    auto hand = gripper();
    hand.nodeset = "no such set";
    EXPECT_EQ(refusal(config("hand", hand)).code, Errc::not_found);
}

TEST_F(GripperOfACell, LetsGoOfItsDeviceWhenItEnds) {
    auto server = serve(config("hand", gripper()));
    ASSERT_TRUE(server);
    EXPECT_NE(lastGripper(), nullptr);
    server.reset();
    EXPECT_EQ(lastGripper(), nullptr);
}

}  // namespace
}  // namespace metier::server::testing
