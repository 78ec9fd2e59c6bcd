// Skill objects that are made at run time, limits that only nodes have, and what is refused.
#include <gmock/gmock.h>

#include "metier/opcua_skill/base_placement.hpp"
#include "metier/opcua_skill/live_figures.hpp"
#include "metier/opcua_skill/skill_controller.hpp"
#include "metier/opcua_skill/skill_dictionary.hpp"
#include "metier/opcua_skill/used_skills.hpp"
#include "metier/opcua_skill/values.hpp"
#include "metier/skill/lambda_skill.hpp"
#include "node_limits.hpp"
#include "served_skills.hpp"

namespace metier::opcua_skill::testing {
namespace {

using opcua::NodeId;
using ::testing::AllOf;
using ::testing::HasSubstr;

class SkillFactory : public ServedSkills {
protected:
    Result<skill::Program*> publish(skill::SkillDescription description,
                                    NodeStyle style = NodeStyle::readable) {
        return skills().publish(
            system().skills,
            std::make_unique<skill::LambdaSkill>(std::move(description), skill::SkillFunctions{}),
            {}, style);
    }
    /// A composed skill with one parameter of its own.
    static skill::SkillDescription composed(std::string name, std::string what, skill::Unit unit) {
        return {.name = std::move(name),
                .type = "SequenceSkillType",
                .parameters = {{.name = "Height",
                                .description = std::move(what),
                                .type = skill::ValueType::number,
                                .unit = unit,
                                .range = skill::Range{0.0, 1.0},
                                .default_value = 0.5}},
                .steps = {"one"}};
    }
    std::string descriptionOf(const std::string& skill) {
        const NodeId node(system().skills.namespaceIndex(),
                          std::get<std::string>(system().skills.identifier()) + "/" + skill +
                              "/ParameterSet/Height");
        return server().nodes().descriptionOf(node).value().text;
    }
};

TEST_F(SkillFactory, SkillsOfOneTypeKeepTheirOwnDescriptionsOfFields) {
    ASSERT_TRUE(publish(composed("Lift", "How high the part is lifted.", skill::kMetre)));
    ASSERT_TRUE(publish(composed("Drop", "How far the part falls.", skill::kMetre)));
    EXPECT_EQ(descriptionOf("Lift"), "How high the part is lifted.");
    EXPECT_EQ(descriptionOf("Drop"), "How far the part falls.");
}

TEST_F(SkillFactory, SkillsOfOneTypeKeepTheirOwnUnits) {
    ASSERT_TRUE(publish(composed("Lift", "Height.", skill::kMetre)));
    ASSERT_TRUE(publish(composed("Turn", "Height.", skill::kRadian)));
    serve();
    const auto client = connect();
    const auto unit = [&](const char* skill) {
        const auto index = system().skills.namespaceIndex();
        const auto object = client->translate(system().skills, {{index, skill}}).value();
        const ServedSkill served{object, nullptr, nullptr};
        return symbolOf(
            readAs<opcua::EuInformation>(*client, served, "ParameterSet/Height/EngineeringUnits"));
    };
    EXPECT_EQ(unit("Lift"), "m");
    EXPECT_EQ(unit("Turn"), "rad");
}

TEST_F(SkillFactory, ASecondCompactSkillOfTheSameNameIsRefused) {
    ASSERT_TRUE(publish(streamDescription(), NodeStyle::compact));
    const auto second = publish(streamDescription(), NodeStyle::compact);
    ASSERT_FALSE(second);
    EXPECT_EQ(second.error().code, Errc::already_exists);
    EXPECT_THAT(second.error().message, HasSubstr("PositionStreamSkill"));
}

TEST_F(SkillFactory, CompactSkillsHaveTheSameIdsAtEveryStart) {
    const auto idsOf = [](opcua::Server& server, const MotionDeviceSystem& system) {
        std::vector<NodeId> ids;
        const auto children = server.nodes().browse(system.skills);
        for (const auto& child : children.value()) {
            ids.push_back(child.target);
        }
        return ids;
    };
    const auto publishAll = [](SkillServer& skills, const MotionDeviceSystem& system) {
        for (int i = 0; i < 20; ++i) {
            auto description = streamDescription();
            description.name = "Stream" + std::to_string(i);
            EXPECT_TRUE(skills.publish(system.skills,
                                       std::make_unique<skill::LambdaSkill>(
                                           std::move(description), skill::SkillFunctions{}),
                                       {}, NodeStyle::compact));
        }
    };
    struct Again : ServedSkills {
        void TestBody() override {}
        using ServedSkills::server;
        using ServedSkills::skills;
        using ServedSkills::system;
    } again;
    publishAll(skills(), system());
    publishAll(again.skills(), again.system());
    const auto ids = idsOf(server(), system());
    EXPECT_EQ(ids.size(), 20U);
    EXPECT_EQ(ids, idsOf(again.server(), again.system()));
}

TEST_F(SkillFactory, APublishedSkillIsNotBoundAgain) {
    const auto skill = add(streamDescription());
    const auto bound = skills().bind(skill.id, std::make_unique<skill::LambdaSkill>(
                                                   streamDescription(), skill::SkillFunctions{}));
    ASSERT_FALSE(bound);
    EXPECT_EQ(bound.error().code, Errc::already_exists);
}

TEST_F(SkillFactory, ASkillThatIsNotSuspendableSaysSo) {
    auto description = streamDescription();
    description.suspendable = false;
    const auto skill = add(description);
    serve();
    const auto client = connect();
    const auto metier = client->namespaceIndex("urn:metier:skills").value();
    const auto node = client->translate(skill.id, {{metier, "Suspendable"}});
    ASSERT_TRUE(node);
    EXPECT_EQ(client->read(*node).value(), opcua::Value::of(false));
}

TEST_F(SkillFactory, RefusesUsesOfWhatIsNotThere) {
    const auto skill = add(streamDescription());
    auto& nodes = server().nodes();
    const RemoteSkill line{"line", "opc.tcp://127.0.0.1:1", "LineSkill", "LineSkillType", "Arm"};
    EXPECT_EQ(updateUse(nodes, skill.id, line).error().code, Errc::not_found);
    ASSERT_TRUE(publishUse(nodes, skill.id, line));
    EXPECT_EQ(publishUse(nodes, skill.id, line).error().code, Errc::already_exists);
    auto other = line;
    other.alias = "curve";
    EXPECT_EQ(updateUse(nodes, skill.id, other).error().code, Errc::not_found);
    const NodeId nowhere(1, std::string("nowhere"));
    EXPECT_EQ(publishUse(nodes, skill.id, nowhere).error().code, Errc::not_found);
    EXPECT_EQ(publishUse(nodes, nowhere, line).error().code, Errc::not_found);
    const auto missing = findSkillObject(nodes, system().skills, "DanceSkill");
    EXPECT_EQ(missing.error().message, "there is no skill DanceSkill");
    EXPECT_EQ(findSkillObject(nodes, system().skills, "PositionStreamSkill").value(), skill.id);
}

TEST_F(SkillFactory, AnotherUsedSkillReplacesWhatItsAliasTold) {
    const auto skill = add(streamDescription());
    auto& nodes = server().nodes();
    ASSERT_TRUE(
        publishUse(nodes, skill.id, RemoteSkill{"line", "opc.tcp://a:1", "A", "AType", ""}));
    ASSERT_TRUE(
        updateUse(nodes, skill.id, RemoteSkill{"line", "opc.tcp://b:2", "B", "BType", "C"}));
    serve();
    const auto client = connect();
    const auto metier = client->namespaceIndex("urn:metier:skills").value();
    const auto told = [&](const char* property) {
        const auto node = client->translate(
            skill.id,
            {{metier, "UsedSkills"}, {skill.id.namespaceIndex(), "line"}, {metier, property}});
        return node ? client->read(*node)->toString() : "missing";
    };
    EXPECT_EQ(told("EndpointUrl"), "opc.tcp://b:2");
    EXPECT_EQ(told("SkillName"), "B");
    EXPECT_EQ(told("SkillTypeName"), "BType");
    EXPECT_EQ(told("ControllerName"), "C");
}

TEST_F(SkillFactory, FiguresOfWhatIsNotThereAreRefused) {
    auto& nodes = server().nodes();
    const NodeId nowhere(1, std::string("nowhere"));
    EXPECT_EQ(publishArmFigures(nodes, nowhere, {.standstill = [] { return std::optional(true); }})
                  .error()
                  .code,
              Errc::not_found);
    const auto nothing = [] { return std::optional<GripperFigures>(); };
    EXPECT_EQ(publishGripperFigures(nodes, nowhere, {0.1, false}, nothing).error().code,
              Errc::not_found);
    ASSERT_TRUE(publishGripperFigures(nodes, system().controller, {0.1, false}, nothing));
    EXPECT_EQ(publishGripperFigures(nodes, system().controller, {0.1, false}, nothing).error().code,
              Errc::already_exists);
    EXPECT_TRUE(publishArmFigures(nodes, nowhere, {})) << "an arm without figures needs no node";
    auto lacking = system();
    lacking.motion_device = nowhere;
    EXPECT_EQ(serveBasePlacement(server(), lacking).error().code, Errc::not_found);
}

TEST(ServerWithoutTheModels, IsRefusedByName) {
    opcua::ServerOptions options;
    options.port = 0;
    options.logger = std::make_shared<spdlog::logger>("quiet");
    const auto server = opcua::Server::create(options).value();
    SystemClock clock;
    const auto skills = SkillServer::create(*server, clock, options.logger);
    ASSERT_FALSE(skills);
    EXPECT_EQ(skills.error().code, Errc::not_found);
    EXPECT_THAT(skills.error().message, HasSubstr("device and metier"));
    EXPECT_EQ(findMotionDeviceSystem(server->nodes()).error().code, Errc::not_found);
    EXPECT_EQ(findSkillController(server->nodes()).error().code, Errc::not_found);
    EXPECT_EQ(publishDictionary(server->nodes()).error().code, Errc::not_found);
    EXPECT_EQ(publishMotionDeviceSystem(server->nodes(), {"Arm", "", "", "", {}}).error().code,
              Errc::not_found);
}

class LimitsOfNodes : public SkillFactory {
protected:
    /// A Variable with that EURange.
    NodeId limited(const char* name, skill::Range range) {
        auto& nodes = server().nodes();
        opcua::VariableSpec spec;
        spec.node.parent = system().controller;
        spec.node.browse_name = {system().skills.namespaceIndex(), name};
        spec.type = NodeId(0, 17570U);  // AnalogUnitRangeType
        spec.data_type = NodeId(0, 11U);
        const auto node = nodes.addVariable(spec).value();
        const auto limit = nodes.find(node, opcua::QualifiedName{0, "EURange"}).value();
        EXPECT_TRUE(nodes.write(limit, opcua::Value::of(range)));
        return node;
    }
    void limit(const char* name, skill::Range range, Part part, std::uint16_t field = 0) {
        limits_.add(server().nodes(), limited(name, range),
                    {NodeKind::parameter, static_cast<std::uint8_t>(part), field});
    }
    std::string refusal(const skill::Field& field, const skill::Value& value,
                        std::uint16_t index = 0) {
        const auto checked = limits_.check(index, field, value);
        return checked ? "" : checked.error().message;
    }

    const skill::Field speed_{.name = "Speed", .unit = skill::kMetrePerSecond};
    NodeLimits limits_;
};

TEST_F(LimitsOfNodes, HoldForEveryNumberOfAValueAndIncludeTheirEnds) {
    limit("Speed", {0.0, 2.0}, Part::whole);
    EXPECT_EQ(refusal(speed_, 2.0), "");
    EXPECT_EQ(refusal(speed_, 2.5), "Speed: 2.5 is outside 0 to 2 m/s");
    EXPECT_EQ(refusal(speed_, std::vector{0.5, -0.25, 3.0}), "Speed: -0.25 is outside 0 to 2 m/s");
    EXPECT_EQ(refusal(speed_, std::vector{skill::Range{0.0, 2.0}, skill::Range{1.0, 4.0}}),
              "Speed: 4 is outside 0 to 2 m/s");
    EXPECT_EQ(refusal(speed_, skill::Value()), "");
    EXPECT_EQ(refusal({.name = "Factor"}, 7.0), "Factor: 7 is outside 0 to 2");
}

TEST_F(LimitsOfNodes, HoldForTheirOwnFieldAndPartOnly) {
    limit("X", {-1.0, 1.0}, Part::x);
    limit("C", {-3.0, 3.0}, Part::c);
    limit("Other", {0.0, 0.1}, Part::whole, 1);
    const skill::Field pose{.name = "Pose", .type = skill::ValueType::frame, .unit = skill::kMetre};
    EXPECT_EQ(refusal(pose, skill::Frame{1, 50, 50, 50, 50, -3}), "");
    EXPECT_EQ(refusal(pose, skill::Frame{1.5, 0, 0, 0, 0, 0}), "Pose.x: 1.5 is outside -1 to 1 m");
    EXPECT_EQ(refusal(pose, skill::Frame{0, 0, 0, 0, 0, 3.5}),
              "Pose.c: 3.5 is outside -3 to 3 rad");
    EXPECT_EQ(refusal(speed_, 0.5, 1), "Speed: 0.5 is outside 0 to 0.1 m/s");
}

TEST_F(LimitsOfNodes, ARangeThatIsEmptyOrReversedLimitsNothing) {
    limit("Empty", {0.0, 0.0}, Part::whole);
    limit("Reversed", {1.0, -1.0}, Part::whole);
    limits_.add(server().nodes(), system().controller, {NodeKind::parameter, 0, 0});
    EXPECT_EQ(refusal(speed_, 1e9), "");
}

}  // namespace
}  // namespace metier::opcua_skill::testing
