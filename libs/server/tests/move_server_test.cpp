#include <gmock/gmock.h>

#include "lab.hpp"
#include "metier/server/discovery_server.hpp"

namespace metier::server::testing {
namespace {

using skill::Value;
using ::testing::HasSubstr;
using ::testing::UnorderedElementsAre;

const std::vector<double> kAway{0.2, -1.4, 0.3, -1.4, 0.1, 0.1};

class MoveComponentOfACell : public Lab {
protected:
    /// A component that takes any robot that the discovery server lists.
    static cell::ServerConfig seeking(const DiscoveryServer& discovery, double reach = 0) {
        cell::MoveComponent move;
        move.discover = true;
        move.rebind_after = 0.5;
        if (reach > 0) {
            move.reach = reach;
        }
        auto seeking = config("any", move);
        seeking.discovery = knownTo(discovery);
        return seeking;
    }
    static cell::Discovery knownTo(const DiscoveryServer& discovery) {
        cell::Discovery known;
        known.servers = {discovery.url()};
        known.period = 0.2;
        return known;
    }
    std::unique_ptr<DiscoveryServer> discoveryServer() const {
        return DiscoveryServer::start({.port = 0}, identity_).value();
    }
    static cell::ServerConfig movesOf(const Server& arm) {
        return config("ur5-move", cell::MoveComponent{.robot = arm.url()});
    }
    static void expectToMove(opcua::Client& client) {
        auto move = open(client, "JointPtpMoveSkill");
        const auto moved = move.run({{"TargetJointPosition", Value(kAway)}}, inAMinute());
        EXPECT_TRUE(moved) << moved.error().message;
    }
};

TEST_F(MoveComponentOfACell, MovesTheArmOfAnotherServer) {
    const auto arm = serve(config("ur5", streamedUr()));
    ASSERT_TRUE(arm);
    const auto moves = serve(movesOf(*arm));
    ASSERT_TRUE(moves);
    const auto client = connect(*moves);
    EXPECT_THAT(skillsOf(*client),
                UnorderedElementsAre("CartesianPtpMoveSkill", "CartesianLinearMoveSkill",
                                     "JointPtpMoveSkill", "JointLinearMoveSkill",
                                     "CartesianPathMoveSkill"));
    expectToMove(*client);
}

TEST_F(MoveComponentOfACell, IsRefusedWithoutItsRobot) {
    const auto nobody = config("move", cell::MoveComponent{.robot = "opc.tcp://127.0.0.1:1"});
    EXPECT_THAT(refusal(nobody).message, HasSubstr("opc.tcp://127.0.0.1:1: "));
}

TEST_F(MoveComponentOfACell, IsRefusedAnArmWithoutAPositionStream) {
    const auto arm = serve(config("iiwa", iiwa()));
    ASSERT_TRUE(arm);
    EXPECT_THAT(refusal(movesOf(*arm)).message, HasSubstr(arm->url()));
}

TEST_F(MoveComponentOfACell, BelievesThePublishedKinematicsMoreThanAModelFile) {
    const auto arm = serve(config("ur5", streamedUr()));
    ASSERT_TRUE(arm);
    const auto moves =
        serve(config("ur5-move", cell::MoveComponent{.robot = arm->url(),
                                                     .model = METIER_MODELS_DIR "/iiwa7.toml"}));
    ASSERT_TRUE(moves);
    expectToMove(*connect(*moves));
}

TEST_F(MoveComponentOfACell, SaysWhatIsWrongInTheModelOfItsRobot) {
    const auto arm = serve(config("ur5", streamedUr()));
    ASSERT_TRUE(arm);
    const auto file = write("arm.toml", "name = 1\n");
    const auto wrong =
        config("move", cell::MoveComponent{.robot = arm->url(), .model = file.string()});
    EXPECT_THAT(refusal(wrong).message, HasSubstr("arm.toml:1"));
}

TEST_F(MoveComponentOfACell, FindsARobotByDiscovery) {
    const auto discovery = discoveryServer();
    auto arm = config("ur5", streamedUr());
    arm.discovery = knownTo(*discovery);
    const auto serving = serve(arm);
    const auto moves = serve(seeking(*discovery, 0.5));
    ASSERT_TRUE(serving && moves);
    expectToMove(*connect(*moves));
}

TEST_F(MoveComponentOfACell, TakesAnotherRobotWhenItsOwnStaysAway) {
    const auto discovery = discoveryServer();
    auto first = config("first", streamedUr());
    first.discovery = knownTo(*discovery);
    auto gone = serve(first);
    const auto moves = serve(seeking(*discovery));
    ASSERT_TRUE(gone && moves);
    auto second = config("second", streamedUr());
    second.discovery = knownTo(*discovery);
    const auto stays = serve(second);
    gone.reset();
    // The component ends its server and starts the next at the same address.
    bool moved = false;
    const auto deadline = inAMinute();
    while (!moved && std::chrono::steady_clock::now() < deadline) {
        const auto client = opcua::Client::connect(moves->url());
        auto address = client ? client::findSkill(**client, "JointPtpMoveSkill")
                              : tl::unexpected(client.error());
        auto move = address ? client::SkillHandle::open(**client, *address)
                            : tl::unexpected(address.error());
        moved = move && move->run({{"TargetJointPosition", Value(kAway)}}, deadline).has_value();
    }
    EXPECT_TRUE(moved);
}

}  // namespace
}  // namespace metier::server::testing
