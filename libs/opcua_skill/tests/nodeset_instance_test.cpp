// Skills at objects that come from a NodeSet.
#include <gmock/gmock.h>

#include "metier/motion/robot_model.hpp"
#include "metier/robot_skills/position_stream_skill.hpp"
#include "metier/skill/lambda_skill.hpp"
#include "served_skills.hpp"

namespace metier::opcua_skill::testing {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

/// The server of a robot whose nodes come from its NodeSet.
class NodeSetInstance : public ::testing::Test {
protected:
    NodeSetInstance() {
        opcua::ServerOptions options;
        options.port = 0;
        options.nodesets = {"device", "robotics", "metier", "universal_robots"};
        options.logger = std::make_shared<spdlog::logger>("quiet");
        server_ = std::move(opcua::Server::create(options).value());
        skills_ = std::move(SkillServer::create(*server_, clock_, options.logger).value());
        system_ = findMotionDeviceSystem(server_->nodes()).value();
    }

    opcua::NodeId skill(const char* name) {
        const auto children = server_->nodes().browse(system_.skills);
        for (const auto& child : children.value()) {
            if (child.browse_name.name == name) {
                return child.target;
            }
        }
        return {};
    }

    /// A node below a skill.
    opcua::NodeId below(const opcua::NodeId& skill, std::initializer_list<const char*> path) {
        auto node = skill;
        for (const auto* name : path) {
            const auto children = server_->nodes().browse(node).value();
            const auto child = std::find_if(children.begin(), children.end(), [&](const auto& one) {
                return one.browse_name.name == name;
            });
            node = child == children.end() ? opcua::NodeId() : child->target;
        }
        return node;
    }
    void deleteBelow(const opcua::NodeId& skill, std::initializer_list<const char*> path) {
        ASSERT_TRUE(server_->nodes().deleteNode(below(skill, path)));
    }
    /// A stream with all fields that it has in products.
    Result<skill::Program*> bindStream(const opcua::NodeId& skill, std::shared_ptr<Hand> hand) {
        auto description = streamDescription();
        description.parameters = robot_skills::positionStreamFields(model_).fields();
        auto results = robot_skills::positionStreamResultFields().fields();
        for (auto& result : results) {
            result.place = skill::Place::final_result;
        }
        description.results = std::move(results);
        return skills_->bind(
            skill, std::make_unique<HandDrivenSkill>(std::move(description), std::move(hand)));
    }

    const motion::RobotModel model_ =
        motion::RobotModel::load(METIER_MODELS_DIR "/ur5.toml").value();
    SystemClock clock_;
    std::unique_ptr<opcua::Server> server_;
    std::unique_ptr<SkillServer> skills_;
    MotionDeviceSystem system_;
};

TEST_F(NodeSetInstance, ServesASkillAtItsPublishedNodes) {
    const auto id = skill("PositionStreamSkill");
    auto hand = std::make_shared<Hand>();
    const auto program =
        skills_->bind(id, std::make_unique<HandDrivenSkill>(streamDescription(), hand));
    ASSERT_TRUE(program) << program.error().message;
    ASSERT_TRUE(server_->start());
    const auto client = opcua::Client::connect(server_->endpointUrl());
    ASSERT_TRUE(client);
    TransitionWatch watch(**client, id);
    const auto start = (*client)->translate(id, {{0, "Start"}});
    ASSERT_TRUE(start);
    ASSERT_TRUE((*client)->call(id, *start));
    EXPECT_EQ(watch.nextName(), "ReadyToRunning");
    hand->execution().finish();
    EXPECT_EQ(watch.nextName(), "RunningToReady");
}

TEST_F(NodeSetInstance, BindsAnObjectOnce) {
    const auto id = skill("PositionStreamSkill");
    const auto bind = [&] {
        return skills_->bind(
            id, std::make_unique<skill::LambdaSkill>(streamDescription(), skill::SkillFunctions{}));
    };
    ASSERT_TRUE(bind());
    const auto second = bind();
    ASSERT_FALSE(second);
    EXPECT_EQ(second.error().code, Errc::already_exists);
}

TEST_F(NodeSetInstance, LeavesOutOptionalResultsThatTheObjectLacks) {
    const auto id = skill("PositionStreamSkill");
    for (const auto* name :
         {"LargestStreamLag", "StreamClockStep", "RefusedSetPoints", "DroppedSetPoints"}) {
        deleteBelow(id, {"FinalResultData", name});
    }
    auto hand = std::make_shared<Hand>();
    const auto program = bindStream(id, hand);
    ASSERT_TRUE(program) << program.error().message;
    ASSERT_TRUE(server_->start());
    const auto client = opcua::Client::connect(server_->endpointUrl());
    ASSERT_TRUE(client);
    TransitionWatch watch(**client, id);
    ASSERT_TRUE((*client)->call(id, below(id, {"Start"})));
    EXPECT_EQ(watch.nextName(), "ReadyToRunning");
    hand->execution().finish(robot_skills::positionStreamResultFields().write({.set_points = 7}));
    EXPECT_EQ(watch.nextName(), "RunningToReady");
    const auto shown = (*client)->read(below(id, {"FinalResultData", "SetPoints"}));
    EXPECT_EQ(shown.value(), opcua::Value::of(std::uint64_t{7}));
}

TEST_F(NodeSetInstance, LeavesOutOptionsIfTheObjectHasNone) {
    const auto id = skill("PositionStreamSkill");
    deleteBelow(id, {"Options"});
    const auto program = bindStream(id, std::make_shared<Hand>());
    EXPECT_TRUE(program) << program.error().message;
}

TEST_F(NodeSetInstance, RefusesAnObjectWithoutWhatItsTypeMakesMandatory) {
    const auto id = skill("PositionStreamSkill");
    deleteBelow(id, {"FinalResultData", "SetPoints"});
    deleteBelow(id, {"FinalResultData", "LargestStreamLag"});
    deleteBelow(id, {"ParameterSet", "TargetJointPosition"});
    const auto program = bindStream(id, std::make_shared<Hand>());
    ASSERT_FALSE(program);
    EXPECT_EQ(program.error().code, Errc::not_found);
    EXPECT_THAT(program.error().message, AllOf(HasSubstr("FinalResultData/SetPoints"),
                                               HasSubstr("ParameterSet/TargetJointPosition"),
                                               Not(HasSubstr("LargestStreamLag"))));
}

}  // namespace
}  // namespace metier::opcua_skill::testing
