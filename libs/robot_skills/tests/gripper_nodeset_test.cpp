// The skills of a gripper at the nodes of the wsg50 NodeSet, met as a published client does.
#include <gmock/gmock.h>
#include <spdlog/logger.h>

#include "gripper_bench.hpp"
#include "metier/opcua/client.hpp"
#include "metier/opcua/server.hpp"
#include "metier/opcua_skill/skill_server.hpp"
#include "metier/robot_skills/move_parameters.hpp"
#include "metier/skill/control.hpp"

namespace metier::robot_skills {
namespace {

using opcua::NodeId;
using opcua::QualifiedName;

constexpr std::string_view kDeviceUri = "https://fortiss.org/UA/Device/";
constexpr std::string_view kDiUri = "http://opcfoundation.org/UA/DI/";
constexpr std::string_view kGripperUri = "https://fortiss.org/UA/wsg50/";

class ServedGripper : public ::testing::Test {
protected:
    ServedGripper() {
        opcua::ServerOptions options;
        options.port = 0;
        options.nodesets = {"device", "robotics", "metier", "wsg50"};
        options.logger = std::make_shared<spdlog::logger>("quiet");
        server = std::move(opcua::Server::create(options).value());
        skills =
            std::move(opcua_skill::SkillServer::create(*server, clock, options.logger).value());
        const auto device_set = NodeId(index(kDiUri), 5001U);
        gripper_node = find(device_set, {index(kGripperUri), "Wsg50"});
        skills_node = find(gripper_node, {index(kDeviceUri), "Skills"});
    }

    std::uint16_t index(std::string_view uri) {
        return server->nodes().namespaceIndex(uri).value();
    }
    NodeId find(const NodeId& start, const QualifiedName& child) {
        return server->nodes().find(start, child).value();
    }
    NodeId skillNode(const std::string& name) {
        return find(skills_node, {index(kDeviceUri), name});
    }

    void bindAll() {
        auto made = makeGripperSkills(gripper);
        for (auto& skill : made.skills) {
            const auto name = skill->description().name;
            const auto bound =
                skills->bind(skillNode(name), std::move(skill), {.resource = made.resource});
            ASSERT_TRUE(bound) << name << ": " << bound.error().message;
        }
    }

    SystemClock clock;
    HandDrivenGripper gripper;
    std::unique_ptr<opcua::Server> server;
    std::unique_ptr<opcua_skill::SkillServer> skills;
    NodeId gripper_node;
    NodeId skills_node;
};

TEST_F(ServedGripper, HasANodeForEveryParameterAndResult) {
    bindAll();
}

TEST_F(ServedGripper, HasANodeSetWhoseRelativeModesAreThoseOfMoves) {
    ASSERT_TRUE(server->start());
    const auto client = opcua::Client::connect(server->endpointUrl()).value();
    const NodeId enumeration(0, 29U);
    const auto names = client->translate(
        enumeration, {{index("urn:metier:skills"), "RelativeMode"}, {0, "EnumStrings"}});
    ASSERT_TRUE(names) << names.error().message;
    const auto published =
        client->read(*names).value().as<std::vector<opcua::LocalizedText>>().value();
    ASSERT_EQ(published.size(), 3U);
    EXPECT_EQ(published.at(static_cast<std::size_t>(Relative::absolute)).text, "Absolute");
    EXPECT_EQ(published.at(static_cast<std::size_t>(Relative::base)).text, "Base");
    EXPECT_EQ(published.at(static_cast<std::size_t>(Relative::tool)).text, "Tool");
}

TEST_F(ServedGripper, IsControlledByLeaseAndLock) {
    auto control = std::make_shared<skill::Control>(skills->executor(), clock);
    const auto served = skills->serveControl(gripper_node, control);
    EXPECT_TRUE(served) << served.error().message;
}

TEST_F(ServedGripper, GraspsForAPublishedClient) {
    bindAll();
    ASSERT_TRUE(server->start());
    const auto client = opcua::Client::connect(server->endpointUrl());
    ASSERT_TRUE(client);
    const auto grasp = skillNode(kGrasp);
    const auto device = index(kDeviceUri);
    const auto force =
        (*client)->translate(grasp, {{index(kDiUri), "ParameterSet"}, {device, "Force"}});
    ASSERT_TRUE(force);
    EXPECT_TRUE((*client)->write(*force, opcua::Value())) << "Null is the gripper's own";
    EXPECT_TRUE((*client)->write(*force, opcua::Value::of(20.0)));
    const auto start = (*client)->translate(grasp, {{0, "Start"}});
    ASSERT_TRUE(start);
    ASSERT_TRUE((*client)->call(grasp, *start));
    const auto number = (*client)->translate(grasp, {{0, "CurrentState"}, {0, "Number"}});
    ASSERT_TRUE(number);
    EXPECT_EQ((*client)->read(*number).value(), opcua::Value::of(std::uint32_t{13}));
    skills.reset();  // and with it the server's thread
    ASSERT_EQ(gripper.asked.size(), 1U);
    EXPECT_EQ(gripper.asked[0].request.force, 20.0);
    gripper.end(fail(Errc::cancelled, "stopped"));
}

}  // namespace
}  // namespace metier::robot_skills
