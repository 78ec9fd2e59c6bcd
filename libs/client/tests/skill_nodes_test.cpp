// Skills that lack something, or have it in another way than ours.
#include "skill_nodes.hpp"

#include <gmock/gmock.h>

#include <map>

#include "served_nodes.hpp"

namespace metier::client {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Pair;
using ::testing::SizeIs;
using ::testing::UnorderedElementsAre;

class NodesOfASkill : public ::testing::Test {
protected:
    NodesOfASkill() {
        skill_.name = "Move";
        skill_.node = served_.program(opcua::ids::kObjectsFolder, skill_.name);
    }

    void addMethods(std::string_view without = "") {
        for (const auto* name : {"Start", "Suspend", "Resume", "Halt", "Reset"}) {
            if (name != without) {
                served_.method(skill_.node, name);
            }
        }
    }
    void addState() {
        const auto state =
            served_.variable(skill_.node, {0, "CurrentState"}, opcua::Value::of("Ready"));
        served_.variable(state, {0, "Number"}, opcua::Value::of(12U));
    }
    opcua::Answer<SkillNodes> read() { return readSkillNodes(served_.client(), skill_); }
    std::string problem() {
        const auto nodes = read();
        return nodes ? "" : nodes.error().message;
    }

    testing::ServedNodes served_;
    SkillAddress skill_;
};

TEST_F(NodesOfASkill, AreThoseThatEveryProgramHasAndNoMore) {
    addMethods();
    addState();
    const auto nodes = read();
    ASSERT_TRUE(nodes) << nodes.error().message;
    EXPECT_EQ(nodes->methods[0], opcua::NodeId(1, "Move.Start"));
    EXPECT_EQ(nodes->program.state_number, opcua::NodeId(1, "Move.CurrentState.Number"));
    for (const auto& none : {nodes->start_with, nodes->check, nodes->get_execution,
                             nodes->reason_text, nodes->execution_id, nodes->records}) {
        EXPECT_TRUE(none.isNull());
    }
    EXPECT_TRUE(nodes->suspendable) << "unless it says that it is not";
    EXPECT_THAT(nodes->parameters, IsEmpty());
    EXPECT_THAT(nodes->results, IsEmpty());
}

TEST_F(NodesOfASkill, AreNoneWithoutStart) {
    addMethods("Start");
    addState();
    EXPECT_THAT(problem(), HasSubstr("Move has no Start"));
}

class SkillWithout : public NodesOfASkill, public ::testing::WithParamInterface<skill::Method> {};

INSTANTIATE_TEST_SUITE_P(Methods, SkillWithout,
                         ::testing::Values(skill::Method::suspend, skill::Method::resume,
                                           skill::Method::halt, skill::Method::reset));

TEST_P(SkillWithout, AnotherMethodHasNoNodeForIt) {
    addMethods(toString(GetParam()));
    addState();
    const auto nodes = read();
    ASSERT_TRUE(nodes) << nodes.error().message;
    const auto missing = static_cast<std::size_t>(GetParam());
    EXPECT_EQ(nodes->suspendable, GetParam() != skill::Method::suspend);
    for (std::size_t i = 0; i < 5; ++i) {
        EXPECT_EQ(nodes->methods.at(i).isNull(), i == missing) << i;
    }
}

TEST_F(NodesOfASkill, NeedACurrentStateAndNothingBelowIt) {
    addMethods();
    EXPECT_THAT(problem(), HasSubstr("Move has no CurrentState"));
    served_.variable(skill_.node, {0, "CurrentState"}, opcua::Value::of("Ready"));
    const auto nodes = read();
    ASSERT_TRUE(nodes) << nodes.error().message;
    EXPECT_EQ(nodes->program.state, opcua::NodeId(1, "Move.CurrentState"));
    EXPECT_TRUE(nodes->program.state_id.isNull());
    EXPECT_TRUE(nodes->program.state_number.isNull());
    EXPECT_TRUE(nodes->program.last.isNull());
}

TEST_F(NodesOfASkill, AreNoneOfANodeThatIsNotThere) {
    skill_.node = {1, "Nothing"};
    EXPECT_EQ(read().error().code, Errc::not_found);
}

TEST_F(NodesOfASkill, LeaveOutFieldsOfTypesThatNoSkillHas) {
    addMethods();
    addState();
    const auto folder = served_.object(skill_.node, "ParameterSet");
    served_.variable(folder, "Id", opcua::Value::of(opcua::Guid{1, 2, 3, {}}));
    served_.variable(folder, "Speed\x1b", opcua::Value::of(0.5));
    served_.object(folder, "Group");
    served_.variable(served_.object(skill_.node, "FinalResultData"), "Name",
                     opcua::Value::of("none"));
    const auto nodes = read();
    ASSERT_TRUE(nodes) << nodes.error().message;
    ASSERT_THAT(nodes->parameters, SizeIs(1));
    const auto& speed = nodes->parameters.front().field;
    EXPECT_EQ(speed.name, "Speed\xEF\xBF\xBD");
    EXPECT_EQ(speed.type, skill::ValueType::number);
    EXPECT_EQ(speed.place, skill::Place::parameter_set);
    ASSERT_THAT(nodes->results, SizeIs(1));
    EXPECT_EQ(nodes->results.front().field.type, skill::ValueType::text);
}

TEST_F(NodesOfASkill, HaveTheRankOfTheirValuesNotADeclaredOneThatIsWrong) {
    addMethods();
    addState();
    const auto folder = served_.object(skill_.node, "ParameterSet");
    const auto add = [&](const char* name, std::int32_t rank, const opcua::Value& value) {
        const opcua::NodeId of_double(0, 11U);
        EXPECT_TRUE(
            served_.nodes().addVariable({.node = {{}, folder, opcua::ids::kHasComponent, {1, name}},
                                         .data_type = of_double,
                                         .value_rank = rank,
                                         .value = value}));
    };
    const auto joints = opcua::Value::of(std::vector{0.1, 0.2, 0.3});
    add("Joints", -3, joints);  // scalar or one dimension
    add("Either", -3, opcua::Value::of(0.5));
    add("Any", -2, joints);
    add("None", -2, {});
    const auto nodes = read();
    ASSERT_TRUE(nodes) << nodes.error().message;
    std::map<std::string, skill::ValueType> types;
    for (const auto& parameter : nodes->parameters) {
        types[parameter.field.name] = parameter.field.type;
    }
    EXPECT_THAT(types, UnorderedElementsAre(Pair("Joints", skill::ValueType::numbers),
                                            Pair("Either", skill::ValueType::number),
                                            Pair("Any", skill::ValueType::numbers),
                                            Pair("None", skill::ValueType::number)));
}

TEST_F(NodesOfASkill, DoNotBelievePropertiesOfOtherTypes) {
    addMethods();
    addState();
    served_.variable(skill_.node, "Suspendable", opcua::Value::of("no"));
    const auto folder = served_.object(skill_.node, "ParameterSet");
    const auto wrong = served_.variable(folder, "Speed", opcua::Value::of(0.5));
    served_.variable(wrong, "EURange", opcua::Value::of("0 to 1"));
    served_.variable(wrong, "EngineeringUnits", opcua::Value::of(7.0));
    const auto strange = served_.variable(folder, "Way", opcua::Value::of(0.5));
    served_.variable(strange, "EURange", opcua::Value::of(opcua::Range{0, 1}));
    served_.variable(
        strange, "EngineeringUnits",
        opcua::Value::of(opcua::EuInformation{"urn:others", 7, {"", "ell"}, {"", "ell"}}));
    const auto nodes = read();
    ASSERT_TRUE(nodes) << nodes.error().message;
    EXPECT_TRUE(nodes->suspendable);
    ASSERT_THAT(nodes->parameters, SizeIs(2));
    EXPECT_FALSE(nodes->parameters[0].field.range);
    EXPECT_EQ(nodes->parameters[0].field.unit.symbol, skill::kOne.symbol);
    ASSERT_TRUE(nodes->parameters[1].field.range);
    EXPECT_EQ(nodes->parameters[1].field.range->high, 1.0);
    EXPECT_EQ(nodes->parameters[1].field.unit.symbol, skill::kOne.symbol) << "a unit of others";
}

}  // namespace
}  // namespace metier::client
