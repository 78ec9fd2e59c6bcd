#include "finding/skill_matching.hpp"

#include <gmock/gmock.h>

namespace metier::server {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

OfferedSkill offer(const std::string& server, const std::string& controller,
                   const std::string& type, const ArmFigures& arm = {}) {
    client::SkillAddress address;
    address.name = type.substr(0, type.size() - std::string("Type").size());
    address.type_name = type;
    address.above = {{controller, {1, 10U}}, {"Skills", {1, 11U}}};
    return {server, 0, std::move(address), arm};
}

composition::Use use(const std::string& type) {
    return {.alias = "arm", .type = type};
}

TEST(SkillMatching, GoesByTheTypeWithItsEndingOrWithout) {
    const auto skill = offer("iiwa", "Arm", "JointPtpMoveSkillType").address;
    EXPECT_TRUE(isOfType(skill, "JointPtpMoveSkillType"));
    EXPECT_FALSE(isOfType(skill, "JointLinearMoveSkillType"));
    EXPECT_FALSE(isOfType(skill, "MoveSkillType")) << "types that it is derived from do not count";
}

TEST(SkillMatching, TakesASkillOfADerivedTypeIfThereIsNoneOfTheVeryType) {
    auto careful = offer("acme", "Arm", "CarefulMoveSkillType");
    careful.address.base_types = {"JointPtpMoveSkillType", "MoveSkillType", "SkillType"};
    const auto plain = offer("iiwa", "Arm", "JointPtpMoveSkillType");
    EXPECT_EQ(choose(use("JointPtpMoveSkillType"), {careful}).value().server, "acme");
    EXPECT_EQ(choose(use("JointPtpMoveSkillType"), {careful, plain}).value().server, "iiwa");
    auto of_acme = use("JointPtpMoveSkillType");
    of_acme.server = "acme";
    EXPECT_EQ(choose(of_acme, {careful, plain}).value().server, "acme")
        << "the very type is not of this server";
    EXPECT_FALSE(choose(use("MoveSkillType"), {careful, careful})) << "which one?";
    EXPECT_FALSE(choose(use("StreamSkillType"), {careful}));
    EXPECT_FALSE(choose(use("JointPtpMoveSkillType"), {careful}, Derived::left_out));
    auto grasp = offer("acme", "Jaws", "CarefulGraspSkillType");
    grasp.address.base_types = {"GraspGripperSkill", "GripperSkillType", "SkillType"};
    EXPECT_TRUE(choose(use("GraspGripperSkillType"), {grasp}))
        << "the published name has no ending";
    auto force = offer("press", "Arm", "CartesianLinearForceMoveSkillType");
    force.address.base_types = {"CartesianLinearMoveSkillType", "MoveSkillType"};
    EXPECT_FALSE(choose(use("CartesianLinearMoveSkillType"), {force})) << "it needs a force";
    EXPECT_TRUE(choose(use("CartesianLinearForceMoveSkillType"), {force}));
}

TEST(SkillMatching, KnowsComposedSkillsByTheirName) {
    client::SkillAddress composed;
    composed.name = "VisitSkill";
    composed.type_name = "SequenceSkillType";
    EXPECT_TRUE(isOfType(composed, "VisitSkillType"));
    EXPECT_FALSE(isOfType(composed, "VisitSkill"));
}

TEST(SkillMatching, ChoosesTheOnlySkillOfAType) {
    const auto chosen =
        choose(use("JointPtpMoveSkillType"), {offer("iiwa", "Arm", "JointLinearMoveSkillType"),
                                              offer("ur5", "Arm", "JointPtpMoveSkillType")});
    ASSERT_TRUE(chosen);
    EXPECT_EQ(chosen->server, "ur5");
}

TEST(SkillMatching, ChoosesAmongSeveralByServerAndController) {
    const std::vector<OfferedSkill> offered{offer("iiwa", "Left", "JointPtpMoveSkillType"),
                                            offer("iiwa", "Right", "JointPtpMoveSkillType"),
                                            offer("ur5", "Left", "JointPtpMoveSkillType")};
    auto wanted = use("JointPtpMoveSkillType");
    const auto several = choose(wanted, offered);
    ASSERT_FALSE(several);
    EXPECT_EQ(several.error().code, Errc::invalid_argument);
    EXPECT_THAT(several.error().message,
                HasSubstr("JointPtpMoveSkill (iiwa, Left), JointPtpMoveSkill (iiwa, Right), "
                          "JointPtpMoveSkill (ur5, Left); choose one by server and controller"));
    wanted.server = "iiwa";
    EXPECT_FALSE(choose(wanted, offered));
    wanted.controller = "Right";
    ASSERT_TRUE(choose(wanted, offered));
    EXPECT_EQ(choose(wanted, offered)->address.controllerName(), "Right");
}

TEST(SkillMatching, RefusesArmsThatAreTooWeakAndThoseNobodyKnows) {
    auto wanted = use("JointPtpMoveSkillType");
    wanted.reach = 0.8;
    wanted.payload = 5.0;
    const auto unfit = choose(wanted, {offer("weak", "A", "JointPtpMoveSkillType", {0.9, 3.0}),
                                       offer("unknown", "A", "JointPtpMoveSkillType")});
    ASSERT_FALSE(unfit);
    EXPECT_EQ(unfit.error().code, Errc::not_found);
    EXPECT_THAT(
        unfit.error().message,
        AllOf(HasSubstr("with a reach of 0.8 m and a payload of 5 kg"),
              HasSubstr("(weak, A, reach 0.900 m, payload 3 kg)"), HasSubstr("(unknown, A)")));
    EXPECT_TRUE(choose(wanted, {offer("strong", "A", "JointPtpMoveSkillType", {0.9, 5.0})}));
}

TEST(SkillMatching, SaysThatThereIsNoneAtAll) {
    EXPECT_THAT(choose(use("GraspGripperSkillType"), {}).error().message,
                HasSubstr("no skill of type GraspGripperSkillType; of that type there are: none"));
}

TEST(SkillMatching, AsksSkillsOfTheSameServerForNothingBesidesTheirType) {
    auto wanted = use("JointPtpMoveSkillType");
    EXPECT_TRUE(checkOwn(wanted));
    wanted.reach = 0.5;
    EXPECT_EQ(checkOwn(wanted).error().code, Errc::invalid_argument);
    wanted = use("JointPtpMoveSkillType");
    wanted.controller = "Arm";
    EXPECT_FALSE(checkOwn(wanted));
    wanted = use("JointPtpMoveSkillType");
    wanted.force = "contact";
    EXPECT_FALSE(checkOwn(wanted));
}

TEST(ArmFigures, AreEnoughIfEachIsKnownAndAtLeastWhatIsWanted) {
    EXPECT_TRUE(isAtLeast({}, {}));
    EXPECT_TRUE(isAtLeast({.reach = 0.8}, {.reach = 0.8}));
    EXPECT_FALSE(isAtLeast({.reach = 0.8}, {.reach = 0.79, .payload = 5.0}));
    EXPECT_FALSE(isAtLeast({.payload = 1.0}, {.reach = 0.9}));
}

TEST(ArmFigures, ReadAsASentenceGoesOn) {
    EXPECT_EQ(textOf(ArmFigures{}), "");
    EXPECT_EQ(textOf(ArmFigures{.reach = 0.5}), " with a reach of 0.5 m");
    EXPECT_EQ(textOf(ArmFigures{.payload = 3.0}), " with a payload of 3 kg");
    EXPECT_EQ(textOf(ArmFigures{.reach = 0.5, .payload = 3.0}),
              " with a reach of 0.5 m and a payload of 3 kg");
}

}  // namespace
}  // namespace metier::server
