// Finding skills on servers that are arranged in other ways than ours.
#include "metier/client/skill_finder.hpp"

#include <gmock/gmock.h>

#include "served_nodes.hpp"

namespace metier::client {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;
using ::testing::UnorderedElementsAre;

const opcua::NodeId kTop = opcua::ids::kObjectsFolder;

class FoundSkills : public ::testing::Test {
protected:
    /// Objects in each other. \return the innermost one
    opcua::NodeId nested(int count) {
        auto inner = kTop;
        for (int i = 1; i <= count; ++i) {
            inner = served_.object(inner, "Level" + std::to_string(i));
        }
        return inner;
    }
    std::vector<std::string> names() {
        std::vector<std::string> all;
        const auto skills = findSkills(served_.client()).value();
        for (const auto& skill : skills) {
            all.push_back(skill.name);
        }
        return all;
    }

    testing::ServedNodes served_;
};

TEST_F(FoundSkills, AreNoneWhereNoProgramIs) {
    served_.object(nested(2), "Skill");
    EXPECT_THAT(names(), IsEmpty());
    const auto missing = findSkill(served_.client(), "Skill");
    ASSERT_FALSE(missing);
    EXPECT_EQ(missing.error().code, Errc::not_found);
}

TEST_F(FoundSkills, MayBeTwelveObjectsBelowAndNoFurther) {
    const auto twelfth = nested(12);
    served_.program(twelfth, "Near");
    served_.program(served_.object(twelfth, "Level13"), "Far");
    const auto skills = findSkills(served_.client()).value();
    ASSERT_THAT(skills, SizeIs(1));
    EXPECT_EQ(skills.front().name, "Near");
    EXPECT_THAT(skills.front().above, SizeIs(12));
    EXPECT_EQ(skills.front().above.back().node, twelfth) << "the nearest one is the last";
}

TEST_F(FoundSkills, AreFoundOnceWhereObjectsLeadInACircle) {
    const auto inner = nested(3);
    const auto skill = served_.program(inner, "Move");
    const opcua::NodeId outer{1, "Level1"};
    ASSERT_TRUE(served_.nodes().addReference(inner, opcua::ids::kOrganizes, outer));
    ASSERT_TRUE(served_.nodes().addReference(kTop, opcua::ids::kOrganizes, skill));
    EXPECT_THAT(names(), UnorderedElementsAre("Move"));
}

TEST_F(FoundSkills, AreNotLookedForBelowAnotherSkill) {
    served_.program(served_.program(kTop, "Outer"), "Inner");
    EXPECT_THAT(names(), UnorderedElementsAre("Outer"));
}

TEST_F(FoundSkills, AreToldApartByTheirController) {
    for (const auto* controller : {"Left", "Right"}) {
        served_.program(served_.object(served_.object(kTop, controller), "Skills"), "Move");
    }
    served_.program(kTop, "Wave");
    auto& client = served_.client();
    const auto both = findSkill(client, "Move");
    ASSERT_FALSE(both);
    EXPECT_EQ(both.error().code, Errc::invalid_argument);
    EXPECT_THAT(both.error().message,
                HasSubstr("2 controllers have a skill 'Move'; say Controller/Move"));
    const auto right = findSkill(client, "Right/Move");
    ASSERT_TRUE(right) << right.error().message;
    EXPECT_EQ(right->controllerName(), "Right");
    EXPECT_FALSE(findSkill(client, "Middle/Move"));
    const auto wave = findSkill(client, "Wave").value();
    EXPECT_EQ(wave.controller(), nullptr);
    EXPECT_EQ(wave.controllerName(), "");
}

TEST_F(FoundSkills, HaveNamesThatAreSafeToPrint) {
    served_.program(served_.object(kTop, "Cell\x1b[2J"), "Move\n");
    const auto skills = findSkills(served_.client()).value();
    ASSERT_THAT(skills, SizeIs(1));
    EXPECT_EQ(skills.front().name, "Move\xEF\xBF\xBD");
    EXPECT_EQ(skills.front().above.front().name, "Cell\xEF\xBF\xBD[2J");
}

TEST_F(FoundSkills, HaveATypeThatEndsAtThatOfPrograms) {
    served_.program(kTop, "Move");
    auto& client = served_.client();
    const auto skill = findSkill(client, "Move").value();
    EXPECT_EQ(skill.type_name, "ProgramStateMachineType");
    SkillAddress folder;
    folder.type = opcua::ids::kFolderType;
    const auto types = typeChain(client, folder);
    ASSERT_TRUE(types) << types.error().message;
    ASSERT_THAT(*types, SizeIs(2)) << "of another type: up to the first of all";
    EXPECT_EQ(types->back().node, opcua::ids::kBaseObjectType);
}

TEST_F(FoundSkills, HaveTheirMethodsInAnyNamespace) {
    const auto skill = served_.program(kTop, "Skill");
    const auto start = served_.method(skill, "Start");
    served_.method(skill, "Suspend");
    const auto suspend = served_.nodes()
                             .addMethod({{opcua::NodeId(1, "PublishedSuspend"),
                                          skill,
                                          opcua::ids::kHasComponent,
                                          {0, "Suspend"}},
                                         {},
                                         {},
                                         {}})
                             .value();
    served_.object(skill, "Halt");
    const auto found = findSkill(served_.client(), "Skill").value();
    EXPECT_EQ(findMethod(served_.client(), found, skill::Method::start).value(), start);
    EXPECT_EQ(findMethod(served_.client(), found, skill::Method::suspend).value(), suspend)
        << "that of OPC 10000-10 before one of the same name";
    const auto missing = findMethod(served_.client(), found, skill::Method::halt);
    ASSERT_FALSE(missing);
    EXPECT_EQ(missing.error().status, opcua::status::kBadNoMatch);
    EXPECT_EQ(missing.error().message, "Skill has no Halt");
}

TEST(SkillAddress, HasTheNearestControllerOfSeveral) {
    SkillAddress skill;
    EXPECT_EQ(skill.controller(), nullptr);
    skill.above = {{"Skills", {}}};
    EXPECT_EQ(skill.controllerName(), "") << "nothing has this folder";
    skill.above = {{"Cell", {}}, {"Skills", {}}, {"Arm", {}}, {"Skills", {}}, {"Moves", {}}};
    EXPECT_EQ(skill.controllerName(), "Arm");
}

}  // namespace
}  // namespace metier::client
