// SRDF files: groups that are chains, named positions, and pairs of links that are not compared.
#include "semantics.hpp"

#include <gmock/gmock.h>

#include <cmath>

namespace metier::robot_files {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Pair;
using ::testing::SizeIs;

/// An SRDF file that was read, with its errors.
struct ReadSemantics {
    explicit ReadSemantics(const std::string& content)
        : file(XmlFile::parse(content, "arm.srdf").value()), semantics(Semantics::read(file)) {}
    std::string errors() const {
        const auto done = file.finish();
        return done ? "" : done.error().message;
    }

    XmlFile file;
    Semantics semantics;
};

TEST(SemanticsFile, HasTheGroupsThatAreChains) {
    const ReadSemantics read(R"(<robot name="arm">
        <group name="arm"><chain base_link="base" tip_link="tool0"/></group>
        <group name="hand"><link name="palm"/></group>
        <group name="wrist"><chain base_link="forearm" tip_link="flange"/></group>
    </robot>)");
    EXPECT_EQ(read.errors(), "");
    const auto& groups = read.semantics.groups();
    ASSERT_THAT(groups, SizeIs(2)) << "a group of links is no chain";
    EXPECT_EQ(groups[0].name, "arm");
    EXPECT_EQ(groups[0].base, "base");
    EXPECT_EQ(groups[0].tip, "tool0");
    EXPECT_EQ(groups[1].name, "wrist");
}

TEST(SemanticsFile, HasAPositionForEachJointOfAState) {
    const ReadSemantics read(R"(<robot name="arm">
        <group_state name="home" group="arm">
            <joint name="one" value="0.5"/>
            <joint name="two" value="-1e-1"/>
            <joint name="planar" value="0.1 0.2 0.3"/>
            <joint name="wrong" value="up"/>
        </group_state>
    </robot>)");
    EXPECT_THAT(read.semantics.state("home"), ElementsAre(Pair("one", 0.5), Pair("two", -0.1)))
        << "a joint with several values is no axis";
    EXPECT_THAT(read.semantics.state("away"), IsEmpty());
}

TEST(SemanticsFile, HasTheFirstOfSeveralStatesOfOneName) {
    const ReadSemantics read(R"(<robot name="arms">
        <group_state name="home" group="left"><joint name="left_1" value="1"/></group_state>
        <group_state name="home" group="right"><joint name="right_1" value="2"/></group_state>
    </robot>)");
    EXPECT_THAT(read.semantics.state("home"), ElementsAre(Pair("left_1", 1.0)));
}

TEST(SemanticsFile, DisablesAPairInEitherOrder) {
    const ReadSemantics read(R"(<robot name="arm">
        <disable_collisions link1="wrist" link2="forearm" reason="Adjacent"/>
        <disable_collisions link1="forearm" link2="wrist" reason="Never"/>
    </robot>)");
    EXPECT_TRUE(read.semantics.isDisabled("wrist", "forearm"));
    EXPECT_TRUE(read.semantics.isDisabled("forearm", "wrist"));
    EXPECT_FALSE(read.semantics.isDisabled("wrist", "base"));
    EXPECT_EQ(read.semantics.disabledCount(), 1U) << "it is the same pair";
}

TEST(SemanticsFile, EnablesPairsOfALinkThatIsDisabledByDefault) {
    const ReadSemantics read(R"(<robot name="arm">
        <disable_default_collisions link="cable"/>
        <enable_collisions link1="base" link2="cable"/>
        <disable_collisions link1="cable" link2="wrist"/>
        <enable_collisions link1="cable" link2="wrist"/>
    </robot>)");
    EXPECT_TRUE(read.semantics.isDisabled("cable", "forearm"));
    EXPECT_FALSE(read.semantics.isDisabled("cable", "base"));
    EXPECT_TRUE(read.semantics.isDisabled("cable", "wrist")) << "a disabled pair stays disabled";
    EXPECT_FALSE(read.semantics.isDisabled("base", "forearm"));
}

TEST(SemanticsFile, NamesThePairThatLacksALink) {
    const ReadSemantics read(
        "<robot name=\"arm\">\n<disable_collisions link1=\"wrist\"/>\n</robot>");
    EXPECT_THAT(read.errors(), HasSubstr("arm.srdf:2: <disable_collisions"));
    EXPECT_THAT(read.errors(), HasSubstr("link2"));
}

TEST(SemanticsFile, IsARobot) {
    const ReadSemantics read("<launch><robot name=\"arm\"/></launch>");
    EXPECT_THAT(read.errors(), HasSubstr("no SRDF file: its outermost element is not <robot>"));
    EXPECT_THAT(read.semantics.groups(), IsEmpty());
}

}  // namespace
}  // namespace metier::robot_files
