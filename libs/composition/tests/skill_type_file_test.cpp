#include "metier/composition/skill_type_file.hpp"

#include <gmock/gmock.h>

#include "metier/composition/composition.hpp"
#include "metier/composition/definition_file.hpp"

namespace metier::composition {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

TEST(SkillTypeFile, DeclaresTypesWithFieldsTermsAndProperties) {
    const auto types = parseSkillTypes(R"(
namespace = "urn:example:welding"
version = "1.2.0"
[[type]]
name = "WeldSkillType"
description = "Welds one spot."
terms = ["weld"]
[type.parameters.Force]
type = "number"
unit = "N"
range = [0, 5000]
default = 100
[type.results.Duration]
type = "number"
unit = "s"
[type.properties.ControlFrequency]
value = 125
unit = "Hz"
description = "How often it is controlled."
[type.properties.Process]
value = "MIG"
[[extend]]
type = "JointPtpMoveSkillType"
[extend.properties.Calibrated]
value = true
)",
                                       "weld.toml");
    ASSERT_TRUE(types) << types.error().message;
    EXPECT_EQ(types->uri, "urn:example:welding");
    EXPECT_EQ(types->version, "1.2.0");
    ASSERT_EQ(types->types.size(), 2U);
    const auto& weld = types->types[0];
    EXPECT_EQ(weld.base, "SkillType");
    EXPECT_THAT(weld.terms, ElementsAre("weld"));
    ASSERT_EQ(weld.parameters.size(), 1U);
    EXPECT_EQ(weld.parameters[0].range, (skill::Range{0, 5000}));
    EXPECT_EQ(weld.results[0].place, skill::Place::final_result);
    ASSERT_EQ(weld.properties.size(), 2U);
    EXPECT_EQ(std::get<double>(weld.properties[0].value), 125.0);
    EXPECT_EQ(weld.properties[0].unit, skill::kHertz);
    EXPECT_EQ(std::get<std::string>(weld.properties[1].value), "MIG");
    EXPECT_TRUE(types->types[1].extends);
    EXPECT_EQ(types->types[1].name, "JointPtpMoveSkillType");
    EXPECT_EQ(std::get<bool>(types->types[1].properties[0].value), true);
}

TEST(SkillTypeFile, NamesItsMistakesTogether) {
    const auto types = parseSkillTypes(R"(
namespace = "welding"
[[type]]
name = "Weld Skill"
[type.properties.Rate]
value = "often"
unit = "Hz"
[type.properties.Bare]
unit = "parsec"
)",
                                       "weld.toml");
    ASSERT_FALSE(types);
    EXPECT_THAT(types.error().message,
                AllOf(HasSubstr("weld.toml:2: namespace: \"welding\" is no URI"),
                      HasSubstr("weld.toml:4: "), HasSubstr("only a number has a unit"),
                      HasSubstr("missing; needs true, false, a number or a text"),
                      HasSubstr("\"parsec\" is no unit that fields have")));
}

TEST(SkillTypeFile, NeedsAType) {
    const auto types = parseSkillTypes("namespace = \"urn:a\"\n", "empty.toml");
    ASSERT_FALSE(types);
    EXPECT_THAT(types.error().message, HasSubstr("needs at least one [[type]] or [[extend]]"));
}

constexpr const char* kComposition = R"(
name = "LiftSkill"
description = "Lifts."
{}
[parameters.Height]
type = "number"
unit = "m"
[uses.line]
type = "CartesianLinearMoveSkillType"
[[step]]
name = "lift"
run = "line"
with.TargetPosition = [0, 0, {{ from = "Height" }}, 0, 0, 0]
)";

TEST(CompositionFile, DeclaresItsOwnType) {
    const auto definition =
        parseDefinition(fmt::format(fmt::runtime(kComposition),
                                    "namespace = \"urn:example:line\"\nterms = [\"lift\"]"),
                        "lift.toml");
    ASSERT_TRUE(definition) << definition.error().message;
    const auto types = skillTypesOf(*definition, descriptionOf(*definition));
    EXPECT_EQ(types.uri, "urn:example:line");
    ASSERT_EQ(types.types.size(), 1U);
    EXPECT_EQ(types.types[0].name, "LiftSkillType");
    EXPECT_EQ(types.types[0].base, "SequenceSkillType");
    EXPECT_THAT(types.types[0].terms, ElementsAre("lift"));
    EXPECT_EQ(types.types[0].parameters[0].name, "Height");
}

TEST(CompositionFile, HasANamespaceOfItsOwnUnlessItNamesOne) {
    const auto definition =
        parseDefinition(fmt::format(fmt::runtime(kComposition), ""), "lift.toml");
    ASSERT_TRUE(definition) << definition.error().message;
    EXPECT_EQ(definition->type_namespace, "urn:metier:composition:LiftSkillType");
}

}  // namespace
}  // namespace metier::composition
