// The nodes of a skill whose fields a file declares.
#include <gmock/gmock.h>

#include "metier/opcua_skill/used_skills.hpp"
#include "metier/opcua_skill/values.hpp"
#include "served_skills.hpp"

namespace metier::opcua_skill::testing {
namespace {

using ::testing::ElementsAre;

class SequenceNodes : public ServedSkills {
protected:
    static skill::SkillDescription description() {
        return {.name = "PickSkill",
                .type = "PickSkillType",
                .description = "Picks.",
                .parameters = {{.name = "Height",
                                .description = "How high.",
                                .type = skill::ValueType::number,
                                .unit = skill::kMetre,
                                .range = skill::Range{0.0, 0.5},
                                .default_value = 0.1},
                               {.name = "Pose", .type = skill::ValueType::frame},
                               {.name = "Names",
                                .type = skill::ValueType::texts,
                                .default_value = std::vector<std::string>{"a"}}},
                .results = {{.name = "Width",
                             .type = skill::ValueType::number,
                             .unit = skill::kMetre,
                             .place = skill::Place::final_result}},
                .steps = {"down", "grasp"}};
    }
};

TEST_F(SequenceNodes, AreMadeForEveryFieldOfTheFile) {
    const auto pick = add(description());
    serve();
    const auto client = connect();
    EXPECT_EQ(readAs<double>(*client, pick, "ParameterSet/Height"), 0.1);
    EXPECT_EQ(readAs<opcua::Range>(*client, pick, "ParameterSet/Height/EURange").high, 0.5);
    EXPECT_EQ(readAs<opcua::EuInformation>(*client, pick, "ParameterSet/Height/EngineeringUnits")
                  .display_name.text,
              "m");
    EXPECT_EQ(client->read(pick.node("ParameterSet/Height"), opcua::AttributeId::description)
                  ->as<opcua::LocalizedText>()
                  ->text,
              "How high.");
    EXPECT_EQ(write(*client, pick, "ParameterSet/Height", opcua::Value::of(0.7)), "BadOutOfRange");
    EXPECT_EQ(write(*client, pick, "ParameterSet/Height", opcua::Value::of(0.3)), "Good");
    EXPECT_EQ(write(*client, pick, "ParameterSet/Pose",
                    toOpcua(skill::Value(skill::Frame{1, 2, 3, 0, 0, 0}))),
              "Good");
    EXPECT_EQ(write(*client, pick, "ParameterSet/Names", opcua::Value::of(1.0)), "BadTypeMismatch");
    EXPECT_THAT(readAs<std::vector<std::string>>(*client, pick, "Steps"),
                ElementsAre("down", "grasp"));
}

TEST_F(SequenceNodes, TellStepProgressExecutionAndResult) {
    const auto pick = add(description());
    serve();
    const auto client = connect();
    ASSERT_EQ(write(*client, pick, "ParameterSet/Pose",
                    toOpcua(skill::Value(skill::Frame{1, 2, 3, 0, 0, 0}))),
              "Good");
    ASSERT_EQ(call(*client, pick, "Start"), "Good");
    ASSERT_TRUE(pick.hand->await("start"));
    const auto execution = pick.hand->execution();
    TransitionWatch watch(*client, pick.id);
    execution.step("grasp");
    execution.progress(0.5);
    // Work that was posted before is done once the server has answered.
    ASSERT_TRUE(server().call([] {}));
    EXPECT_EQ(readAs<std::string>(*client, pick, "CurrentStep"), "grasp");
    EXPECT_EQ(readAs<double>(*client, pick, "Progress"), 0.5);
    EXPECT_EQ(readAs<std::string>(*client, pick, "ExecutionId"), execution.id());
    execution.finish({{"Width", 0.04}});
    EXPECT_EQ(watch.nextName(), "RunningToReady");
    EXPECT_EQ(readAs<double>(*client, pick, "FinalResultData/Width"), 0.04);
    EXPECT_EQ(readAs<std::string>(*client, pick, "CurrentStep"), "");
    EXPECT_EQ(readAs<double>(*client, pick, "Progress"), 0.0);
    EXPECT_EQ(readAs<std::string>(*client, pick, "ExecutionId"), execution.id());
}

TEST_F(SequenceNodes, AreOfTheTypeThatTheFileNamesIfThereIsOne) {
    auto place = description();
    place.type = "PickPlaceSkillType";
    const auto frame = [](const char* name) {
        return skill::Field{.name = name, .type = skill::ValueType::frame};
    };
    const auto number = [](const char* name, skill::Unit unit) {
        return skill::Field{
            .name = name, .type = skill::ValueType::number, .unit = unit, .default_value = 1.0};
    };
    place.parameters = {frame("PickPose"), frame("PlacePose"),
                        number("ApproachDistance", skill::kMetre),
                        number("GraspForce", skill::kNewton), number("Extra", skill::kOne)};
    const auto result = skill::Place::final_result;
    place.results = {{.name = "Steps", .type = skill::ValueType::texts, .place = result},
                     {.name = "StepDurations",
                      .type = skill::ValueType::numbers,
                      .unit = skill::kSecond,
                      .place = result},
                     {.name = "PartHeld", .type = skill::ValueType::boolean, .place = result}};
    const auto pick = add(place);
    serve();
    const auto client = connect();
    const auto robotics = client->namespaceIndex("https://fortiss.org/UA/Robotics/").value();
    const auto type =
        client->browse({.node = pick.id, .reference_type = opcua::ids::kHasTypeDefinition}).value();
    ASSERT_EQ(type.size(), 1U);
    EXPECT_EQ(type.front().target, opcua::NodeId(robotics, 20217U));
    EXPECT_EQ(write(*client, pick, "ParameterSet/ApproachDistance", opcua::Value::of(0.2)), "Good");
    EXPECT_EQ(readAs<double>(*client, pick, "ParameterSet/Extra"), 1.0) << "the file's own";
    EXPECT_THAT(readAs<std::vector<std::string>>(*client, pick, "Steps"),
                ElementsAre("down", "grasp"));
    EXPECT_EQ(readAs<std::string>(*client, pick, "CurrentStep"), "");
}

TEST_F(SequenceNodes, ReferToTheSkillsThatAreUsed) {
    const auto pick = add(description());
    auto inner = description();
    inner.name = "InnerSkill";
    const auto used = add(inner);
    auto& nodes = server().nodes();
    ASSERT_TRUE(publishUse(nodes, pick.id, used.id));
    ASSERT_TRUE(publishUse(
        nodes, pick.id,
        RemoteSkill{"line", "opc.tcp://127.0.0.1:4840", "LineSkill", "LineSkillType", "Arm"}));
    serve();
    const auto client = connect();
    const auto metier = client->namespaceIndex("urn:metier:skills").value();
    const auto references =
        client->browse({.node = pick.id, .reference_type = {metier, 20306U}}).value();
    ASSERT_EQ(references.size(), 2U);
    EXPECT_EQ(references[0].target, used.id);
    EXPECT_EQ(references[1].browse_name.name, "line");
    const auto endpoint =
        client->translate(references[1].target, {{metier, "EndpointUrl"}}).value();
    EXPECT_EQ(client->read(endpoint)->as<std::string>(), "opc.tcp://127.0.0.1:4840");
}

}  // namespace
}  // namespace metier::opcua_skill::testing
