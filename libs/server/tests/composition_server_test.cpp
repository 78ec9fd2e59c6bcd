#include <gmock/gmock.h>

#include "lab.hpp"
#include "metier/client/skill_references.hpp"
#include "metier/server/discovery_server.hpp"

namespace metier::server::testing {
namespace {

using skill::Value;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::SizeIs;
using ::testing::UnorderedElementsAre;

const std::vector<double> kAway{0.2, 0.3, 0.1, -1.2, 0.1, 0.9, 0.1};

class CompositionOfACell : public Lab {
protected:
    /// A file of one step that moves the axes. \param wishes lines of its use
    std::filesystem::path swing(const std::string& wishes = "") const {
        return write("swing.toml", R"(name = "SwingSkill"
[parameters.Target]
type = "numbers"
unit = "rad"
length = 7
[uses.arm]
type = "JointPtpMoveSkillType"
)" + wishes + R"(
[[step]]
name = "swing"
run = "arm"
with.TargetJointPosition = { from = "Target" }
)");
    }
    /// A file of one step that swings.
    std::filesystem::path wave() const {
        return write("wave.toml", R"(name = "WaveSkill"
[parameters.Target]
type = "numbers"
unit = "rad"
length = 7
[uses.swing]
type = "SwingSkillType"
[[step]]
name = "wave"
run = "swing"
with.Target = { from = "Target" }
)");
    }
    static cell::ServerConfig composed(std::vector<std::filesystem::path> files,
                                       std::vector<cell::UsedServer> servers) {
        cell::CompositionServer composition;
        composition.files = std::move(files);
        composition.servers = std::move(servers);
        return config("composed", composition);
    }
    static void expectToMove(opcua::Client& client, const std::string& skill) {
        auto move = open(client, skill);
        const auto moved = move.run({{"Target", Value(kAway)}}, inAMinute());
        EXPECT_TRUE(moved) << moved.error().message;
    }
    static std::vector<client::SkillUse> usesOf(opcua::Client& client, const std::string& skill) {
        const auto address = client::findSkill(client, skill).value();
        const auto reader = client::ReferenceReader::create(client).value();
        return reader.read(address.node).value().uses;
    }
};

TEST_F(CompositionOfACell, RunsSkillsOfOtherServersAndItsOwnAndTellsWhich) {
    const auto arm = serve(config("iiwa", iiwa()));
    ASSERT_TRUE(arm);
    // The file of a skill that another one uses may come after it.
    const auto server = serve(composed({wave(), swing()}, {{"iiwa", arm->url()}}));
    ASSERT_TRUE(server);
    const auto client = connect(*server);
    EXPECT_THAT(skillsOf(*client), UnorderedElementsAre("SwingSkill", "WaveSkill"));
    expectToMove(*client, "WaveSkill");
    const auto swings = usesOf(*client, "SwingSkill");
    ASSERT_THAT(swings, SizeIs(1));
    EXPECT_EQ(swings[0].endpoint_url, arm->url());
    EXPECT_EQ(swings[0].name, "JointPtpMoveSkill");
    const auto waves = usesOf(*client, "WaveSkill");
    ASSERT_THAT(waves, SizeIs(1));
    EXPECT_EQ(waves[0].node, client::findSkill(*client, "SwingSkill").value().node);
}

TEST_F(CompositionOfACell, IsRefusedWhereNobodyOffersWhatItUses) {
    const auto arm = serve(config("ur5", streamedUr()));
    ASSERT_TRUE(arm);
    const auto why = refusal(composed({swing()}, {{"ur5", arm->url()}}));
    EXPECT_THAT(why.message,
                HasSubstr("swing.toml:6: uses.arm: no skill of type JointPtpMoveSkillType"));
}

TEST_F(CompositionOfACell, GoesWithoutAnOptionalSkillThatNobodyOffers) {
    const auto arm = serve(config("iiwa", iiwa()));
    ASSERT_TRUE(arm);
    const auto file = swing(R"([uses.grip]
type = "GraspGripperSkillType"
optional = true
[[step]]
name = "grasp"
run = "grip")");
    const auto server = serve(composed({file}, {{"iiwa", arm->url()}}));
    ASSERT_TRUE(server);
    const auto client = connect(*server);
    expectToMove(*client, "SwingSkill");
    EXPECT_THAT(usesOf(*client, "SwingSkill"), SizeIs(1));
}

TEST_F(CompositionOfACell, IsRefusedWhereSeveralOfferItUnlessItNamesOne) {
    const auto left = serve(config("left", iiwa()));
    const auto right = serve(config("right", iiwa()));
    ASSERT_TRUE(left && right);
    const std::vector<cell::UsedServer> both{{"left", left->url()}, {"right", right->url()}};
    EXPECT_THAT(refusal(composed({swing()}, both)).message,
                HasSubstr("uses.arm: several skills of type JointPtpMoveSkillType"));
    const auto server = serve(composed({swing("server = \"right\"")}, both));
    ASSERT_TRUE(server);
    EXPECT_EQ(usesOf(*connect(*server), "SwingSkill")[0].endpoint_url, right->url());
}

TEST_F(CompositionOfACell, IsRefusedAnArmThatReachesLessThanItNeeds) {
    const auto arm = serve(config("iiwa", iiwa()));
    ASSERT_TRUE(arm);
    const auto why = refusal(composed({swing("reach = 5.0")}, {{"iiwa", arm->url()}}));
    EXPECT_THAT(why.message, HasSubstr("with a reach of 5 m"));
}

TEST_F(CompositionOfACell, IsRefusedWithoutAServerThatItUses) {
    const auto why = refusal(composed({swing()}, {{"iiwa", "opc.tcp://127.0.0.1:1"}}));
    EXPECT_FALSE(why.message.empty());
}

TEST_F(CompositionOfACell, SaysEverythingThatIsWrongInItsFiles) {
    const auto why = refusal(composed(
        {write("one.toml", "name = 1\n"), write("two.toml", "name = \"TwoSkill\"\n")}, {}));
    EXPECT_EQ(why.code, Errc::invalid_argument);
    EXPECT_THAT(why.message, HasSubstr("one.toml:1"));
    EXPECT_THAT(why.message, HasSubstr("two.toml"));
}

TEST_F(CompositionOfACell, UsesAnotherServerWhenTheOneThatItFoundStaysAway) {
    const auto discovery = DiscoveryServer::start({.port = 0}, identity_).value();
    const auto known = [&](cell::ServerConfig config) {
        config.discovery.servers = {discovery->url()};
        config.discovery.period = 0.2;
        return config;
    };
    auto gone = serve(known(config("first", iiwa())));
    auto composition = known(composed({swing()}, {}));
    auto& part = *composition.as<cell::CompositionServer>();
    part.discover = true;
    part.rebind_after = 0.5;
    const auto server = serve(composition);
    ASSERT_TRUE(gone && server);
    const auto client = connect(*server);
    expectToMove(*client, "SwingSkill");
    const auto stays = serve(known(config("second", iiwa())));
    gone.reset();
    const auto deadline = inAMinute();
    while (usesOf(*client, "SwingSkill")[0].endpoint_url != stays->url() &&
           std::chrono::steady_clock::now() < deadline) {
    }
    expectToMove(*client, "SwingSkill");
}

}  // namespace
}  // namespace metier::server::testing
