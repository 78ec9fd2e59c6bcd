#include "metier/opcua_skill/skill_types.hpp"

#include <gmock/gmock.h>

#include "metier/opcua_skill/values.hpp"
#include "metier/skill/lambda_skill.hpp"
#include "metier/skill/typed_skill.hpp"
#include "served_skills.hpp"

namespace metier::opcua_skill::testing {
namespace {

using opcua::NodeId;
using skill::SkillType;
using ::testing::AllOf;
using ::testing::HasSubstr;

constexpr const char* kUri = "urn:example:welding";

struct Weld {
    double current = 0.0;
    std::string wire;
};
struct Welded {
    double duration = 0.0;
};

/// A skill of a program that knows nothing of OPC UA.
class WeldSkill final : public skill::TypedSkill<Weld, Welded> {
public:
    WeldSkill()
        : TypedSkill(
              {.name = "WeldSkill", .type = "WeldSkillType", .description = "Welds <one> spot."},
              parameters(), results()) {}

private:
    static skill::FieldList<Weld> parameters() {
        skill::FieldList<Weld> list;
        list.add(&Weld::current, {.name = "Current",
                                  .description = "Force of the tongs.",
                                  .unit = skill::kNewton,
                                  .range = skill::Range{0.0, 5000.0},
                                  .default_value = 100.0});
        list.add(&Weld::wire, {.name = "Wire", .default_value = std::string("steel")});
        return list;
    }
    static skill::FieldList<Welded> results() {
        skill::FieldList<Welded> list;
        list.add(&Welded::duration, {.name = "Duration", .unit = skill::kSecond});
        return list;
    }
    Result<std::unique_ptr<skill::ExecutionWork>> plan(const Weld& /*parameters*/) override {
        return fail(Errc::not_supported, "no tongs");
    }
};

class SkillTypesTest : public ServedSkills {
protected:
    static SkillType weldType() {
        auto type = skill::skillTypeOf(WeldSkill().description());
        type.terms = {"weld", "urn:others:join"};
        type.properties = {{.name = "ControlFrequency", .value = 125.0, .unit = skill::kHertz},
                           {.name = "Process", .value = std::string("MIG & MAG")}};
        return type;
    }

    opcua::AddressSpace& nodes() { return server().nodes(); }
    NodeId id(const std::string& path) { return {nodes().namespaceIndex(kUri).value(), path}; }
    std::string refusal(std::vector<SkillType> types) {
        const auto declared = declareTypes(nodes(), {.uri = kUri, .types = std::move(types)});
        return declared ? "" : declared.error().message;
    }
};

TEST_F(SkillTypesTest, HaveStableIdsAndMandatoryChildren) {
    const auto declared = declareTypes(nodes(), {.uri = kUri, .types = {weldType()}});
    ASSERT_TRUE(declared) << declared.error().message;
    EXPECT_EQ(nodes().descriptionOf(id("WeldSkillType"))->text, "Welds <one> spot.");
    for (const auto* path :
         {"WeldSkillType/ParameterSet", "WeldSkillType/ParameterSet/Current",
          "WeldSkillType/ParameterSet/Wire", "WeldSkillType/FinalResultData/Duration"}) {
        const auto rules = nodes().browse(id(path), {NodeId(0, 37U)});
        ASSERT_TRUE(rules) << path;
        EXPECT_EQ(rules->front().browse_name.name, "Mandatory") << path;
    }
    const auto range = nodes().read(id("WeldSkillType/ParameterSet/Current/EURange"));
    EXPECT_EQ(range->value.as<opcua::Range>(), (opcua::Range{0.0, 5000.0}));
    const auto unit = nodes().read(id("WeldSkillType/ControlFrequency/EngineeringUnits"));
    EXPECT_EQ(unit->value.as<opcua::EuInformation>()->display_name.text, "Hz");
    EXPECT_EQ(nodes().read(id("WeldSkillType/Process"))->value.as<std::string>(), "MIG & MAG");
    const auto entries = nodes().browse(id("WeldSkillType"), {NodeId(0, 17597U)});
    ASSERT_EQ(entries->size(), 2U);
    EXPECT_EQ(entries->front().browse_name.name, "urn:metier:dictionary:weld");
}

TEST_F(SkillTypesTest, AreTheTypesOfPublishedSkills) {
    ASSERT_TRUE(declareTypes(nodes(), {.uri = kUri, .types = {weldType()}}));
    const auto published = skills().publish(system().skills, std::make_unique<WeldSkill>());
    ASSERT_TRUE(published) << published.error().message;
    const auto index = system().skills.namespaceIndex();
    const auto object = nodes().find(system().skills, {index, "WeldSkill"}).value();
    const auto type = nodes().browse(object, {opcua::ids::kHasTypeDefinition});
    EXPECT_EQ(type->front().target, id("WeldSkillType"));
    // Facts of the type are seen at the skill.
    EXPECT_TRUE(nodes().find(object, {nodes().namespaceIndex(kUri).value(), "ControlFrequency"}));
}

TEST_F(SkillTypesTest, MayBeDerivedFromEachOtherAndFromTypesOfTheModel) {
    SkillType spot;
    spot.name = "SpotWeldSkillType";
    spot.base = "WeldSkillType";
    spot.parameters = {{.name = "Current", .type = skill::ValueType::number},
                       {.name = "Spots", .type = skill::ValueType::uint32}};
    SkillType move;
    move.name = "CarefulMoveSkillType";
    move.base = "JointPtpMoveSkillType";
    ASSERT_EQ(refusal({spot, weldType(), move}), "");
    // What the base has is not declared again.
    EXPECT_FALSE(nodes().exists(id("SpotWeldSkillType/ParameterSet/Current")));
    EXPECT_TRUE(nodes().exists(id("SpotWeldSkillType/ParameterSet/Spots")));
    EXPECT_TRUE(hasSkillType(nodes(), "CarefulMoveSkillType"));
}

TEST_F(SkillTypesTest, MayExtendATypeOfTheModel) {
    SkillType more;
    more.name = "JointPtpMoveSkillType";
    more.extends = true;
    more.properties = {{.name = "Accuracy", .value = 0.0001, .unit = skill::kMetre}};
    more.terms = {"swing"};
    ASSERT_EQ(refusal({more}), "");
    const auto robotics = nodes().namespaceIndex("https://fortiss.org/UA/Robotics/").value();
    bool found = false;
    const auto accuracy = id("JointPtpMoveSkillType/Accuracy");
    const auto above =
        nodes().browse(accuracy, {opcua::ids::kHasComponent, opcua::BrowseDirection::inverse});
    for (const auto& type : above.value()) {
        found =
            found || type.browse_name == opcua::QualifiedName{robotics, "JointPtpMoveSkillType"};
    }
    EXPECT_TRUE(found);
}

TEST_F(SkillTypesTest, OfOneNamespaceMayBeDeclaredOneAfterTheOther) {
    SkillType grind;
    grind.name = "GrindSkillType";
    grind.terms = {"weld", "grind"};
    ASSERT_EQ(refusal({weldType()}), "");
    ASSERT_EQ(refusal({grind}), "");
    EXPECT_EQ(nodes().browse(id("GrindSkillType"), {NodeId(0, 17597U)})->size(), 2U);
}

TEST_F(SkillTypesTest, OfComposedSkillsAreBelowSequenceSkillType) {
    const skill::SkillDescription lift{.name = "LiftSkill",
                                       .type = "LiftSkillType",
                                       .parameters = {{.name = "Height",
                                                       .description = "How high.",
                                                       .type = skill::ValueType::number,
                                                       .unit = skill::kMetre,
                                                       .range = skill::Range{0.0, 1.0},
                                                       .default_value = 0.5}},
                                       .steps = {"one"}};
    ASSERT_EQ(refusal({skill::skillTypeOf(lift, "SequenceSkillType")}), "");
    const auto published = skills().publish(
        system().skills, std::make_unique<skill::LambdaSkill>(lift, skill::SkillFunctions{}));
    ASSERT_TRUE(published) << published.error().message;
    const auto index = system().skills.namespaceIndex();
    const auto object = nodes().find(system().skills, {index, "LiftSkill"}).value();
    EXPECT_EQ(nodes().browse(object, {opcua::ids::kHasTypeDefinition})->front().target,
              id("LiftSkillType"));
    const auto metier = nodes().namespaceIndex("urn:metier:skills").value();
    EXPECT_TRUE(nodes().find(object, {metier, "CurrentStep"}));
    const auto height =
        NodeId(index, std::get<std::string>(object.identifier()) + "/ParameterSet/Height");
    EXPECT_EQ(nodes().descriptionOf(height)->text, "How high.");
    EXPECT_EQ(nodes().read(height)->value.as<double>(), 0.5);
}

TEST_F(SkillTypesTest, AreRefusedWithAllMistakes) {
    SkillType orphan;
    orphan.name = "OrphanSkillType";
    orphan.base = "NoSkillType";
    SkillType known;
    known.name = "JointPtpMoveSkillType";
    SkillType nothing;
    nothing.name = "NothingType";
    nothing.extends = true;
    EXPECT_THAT(
        refusal({orphan, known, nothing, weldType(), weldType()}),
        AllOf(HasSubstr("OrphanSkillType: there is no skill type NoSkillType to derive it from"),
              HasSubstr("JointPtpMoveSkillType: the server has a skill type of that name"),
              HasSubstr("NothingType: there is no such skill type to extend"),
              HasSubstr("WeldSkillType: the name is empty, or declared twice")));
}

TEST_F(SkillTypesTest, ThatAreDerivedFromThemselvesAreRefused) {
    SkillType one;
    one.name = "OneSkillType";
    one.base = "OtherSkillType";
    SkillType other;
    other.name = "OtherSkillType";
    other.base = "OneSkillType";
    EXPECT_THAT(refusal({one, other}), HasSubstr("OneSkillType: its base is derived from it"));
}

}  // namespace
}  // namespace metier::opcua_skill::testing
