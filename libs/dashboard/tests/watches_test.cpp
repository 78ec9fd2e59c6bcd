// The servers that are watched, and what each of them is found to offer.
#include "watches.hpp"

#include <gmock/gmock.h>

#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cstdint>
#include <string>

#include "cell_bench.hpp"
#include "metier/opcua_skill/used_skills.hpp"

namespace metier::dashboard {
namespace {

using nlohmann::json;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Pair;

/// A port of loopback for a server that ends and comes back: as long as this lives, no test beside
/// this one gets it for a free one. It does not listen, so a server may.
class KeptPort {
public:
    KeptPort() {
        const int yes = 1;
        sockaddr_in address{};
        address.sin_family = AF_INET;
        address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
        socklen_t size = sizeof address;
        auto* generic = reinterpret_cast<sockaddr*>(&address);
        EXPECT_EQ(setsockopt(socket_, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes), 0);
        EXPECT_EQ(bind(socket_, generic, size), 0);
        EXPECT_EQ(getsockname(socket_, generic, &size), 0);
        number_ = ntohs(address.sin_port);
    }
    ~KeptPort() { close(socket_); }
    KeptPort(const KeptPort&) = delete;
    KeptPort& operator=(const KeptPort&) = delete;

    std::uint16_t number() const { return number_; }

private:
    const int socket_ = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    std::uint16_t number_ = 0;
};

class WatchedServers : public CellBench {
protected:
    json serverOf(const std::string& key) const {
        const auto cell = board_.cell();
        for (const auto& server : cell.at("servers")) {
            if (server.at("key") == key) {
                return server;
            }
        }
        return {};
    }
    std::string awaitError(const std::string& key) {
        return shown_
            .await("server",
                   [&](const json& told) {
                       return told.at("key") == key && told.at("connected") == false;
                   })
            .at("error");
    }
};

TEST_F(WatchedServers, AreKnownByNameAndAddressOnce) {
    watches_.add({.name = "a", .url = "opc.tcp://127.0.0.1:1"});
    watches_.add({.name = "b", .url = "opc.tcp://127.0.0.1:2"});
    watches_.add({.name = "a", .url = "opc.tcp://127.0.0.1:3"});
    watches_.add({.name = "c", .url = "opc.tcp://127.0.0.1:1"});
    EXPECT_THAT(watches_.servers(), ElementsAre("a", "b"));
    EXPECT_EQ(watches_.url("a").value(), "opc.tcp://127.0.0.1:1");
    EXPECT_EQ(watches_.url("c").error().code, Errc::not_found);
    EXPECT_EQ(watches_.link("c"), nullptr);
}

TEST_F(WatchedServers, HaveNoSkillsBeforeTheyAreConnected) {
    watches_.add({.name = "a", .url = "opc.tcp://127.0.0.1:1"});
    EXPECT_EQ(watches_.skill("a/C/Move").error().code, Errc::connection_lost);
    EXPECT_EQ(watches_.skill("b/C/Move").error().code, Errc::not_found);
    EXPECT_EQ(watches_.skill("").error().code, Errc::not_found);
}

TEST_F(WatchedServers, AreUsedAsTheCellFileSays) {
    watches_.add({.name = "arm", .url = "opc.tcp://127.0.0.1:1"});
    watches_.add({.name = "move", .url = "opc.tcp://127.0.0.1:2", .uses = {"arm"}});
    watches_.add({.name = "all", .url = "opc.tcp://127.0.0.1:3", .uses = {"move", "arm"}});
    EXPECT_THAT(watches_.usedServers(), ElementsAre(Pair("arm", "move"), Pair("move", "all")));
}

TEST_F(WatchedServers, ThatCannotBeReachedSayWhyAndWhatToDo) {
    watches_.add({.name = "away", .url = "opc.tcp://127.0.0.1:1"});
    EXPECT_THAT(awaitError("away"), AllOf(HasSubstr("127.0.0.1:1"), HasSubstr("; ask a person")));
}

TEST_F(WatchedServers, ThatMayNotBeConnectedToSayWhyWithoutControlCharacters) {
    refuse_options_ = [] {
        return std::optional(Error{Errc::access_denied, "no trust\x1b[2J in it"});
    };
    watches_.add({.name = "closed", .url = "opc.tcp://127.0.0.1:1"});
    const auto error = awaitError("closed");
    EXPECT_THAT(error, HasSubstr("no trust"));
    EXPECT_EQ(error.find('\x1b'), std::string::npos);
}

TEST_F(WatchedServers, AreConnectedToAnewAfterTheirEnd) {
    const KeptPort port;
    auto arm = std::make_unique<ArmByHand>(system_tests::BenchOptions{.port = port.number()});
    arm->serve();
    watch({.name = "arm", .url = arm->url()});
    const auto before = watches_.link("arm");
    arm.reset();
    awaitError("arm");
    EXPECT_EQ(board_.skill(keyOf("arm", "MoveSkill"))->state, "Unknown");
    ArmByHand again({.port = port.number()});
    again.serve();
    awaitConnected("arm");
    EXPECT_NE(watches_.link("arm"), before);
    EXPECT_TRUE(watches_.skill(keyOf("arm", "MoveSkill")));
    EXPECT_EQ(board_.skill(keyOf("arm", "MoveSkill"))->state, "Ready");
}

TEST_F(WatchedServers, OfferSkillsOfOneControllerAndItsArm) {
    ArmByHand arm;
    arm.serve();
    watch({.name = "arm", .url = arm.url(), .world_from_base = Frame{1, 0, 0, 0, 0, 0}});
    const auto shown = serverOf("arm");
    EXPECT_EQ(shown.at("application_uri"), "urn:metier:server");
    EXPECT_EQ(shown.at("arm"), "arm");
    EXPECT_TRUE(shown.at("gripper").is_null());
    ASSERT_EQ(shown.at("skills").size(), 2U);
    const auto& move = shown.at("skills").at(0);
    EXPECT_EQ(move.at("key"), keyOf("arm", "MoveSkill"));
    EXPECT_EQ(move.at("type"), "JointPtpMoveSkillType");
    EXPECT_EQ(move.at("controller"), "BenchController");
    EXPECT_EQ(move.at("arm"), "arm");
    EXPECT_EQ(move.at("can"), json::parse(R"({"check":true,"suspend":true,"start_with":true})"));
    const auto& target = move.at("parameters").at(0);
    EXPECT_EQ(target.at("name"), "TargetJointPosition");
    EXPECT_EQ(target.at("unit"), "rad");
    EXPECT_EQ(target.at("rank"), 2);
    EXPECT_EQ(target.at("maximum"), 100.0);

    const auto arms = board_.cell().at("arms");
    ASSERT_EQ(arms.size(), 1U);
    EXPECT_EQ(arms.at(0).at("base"), json::array({1, 0, 0, 0, 0, 0}));
    EXPECT_EQ(arms.at(0).at("joints").size(), 2U);
    EXPECT_EQ(watches_.link("arm")->controllers().size(), 1U) << "two skills have it";
}

TEST_F(WatchedServers, MoveTheArmOfAnotherServerAsTheCellFileSays) {
    ArmByHand component;
    component.serve();
    watch({.name = "move", .url = component.url(), .arm_of = "ur5"});
    EXPECT_EQ(serverOf("move").at("skills").at(0).at("arm"), "ur5");
    EXPECT_TRUE(serverOf("move").at("arm").is_null());
    EXPECT_EQ(board_.cell().at("arms"), json::array()) << "that one shows it";
}

TEST_F(WatchedServers, UseOthersAsTheirOwnReferencesSay) {
    ArmByHand arm;
    arm.serve();
    ArmByHand component;
    const auto publish = [&](const std::string& alias, const std::string& url) {
        ASSERT_TRUE(opcua_skill::publishUse(
            component.bench().server().nodes(), component.bench().node("MoveSkill"),
            opcua_skill::RemoteSkill{alias, url, "MoveSkill", "JointPtpMoveSkillType",
                                     "BenchController"}));
    };
    publish("elsewhere", "opc.tcp://elsewhere:4840");
    publish("arm", arm.url());
    component.serve();
    watch({.name = "arm", .url = arm.url()});
    watch({.name = "move", .url = component.url()});
    EXPECT_EQ(serverOf("move").at("uses"), json::array({"arm"})) << "and none outside of the cell";
    EXPECT_EQ(serverOf("move").at("skills").at(0).at("arm"), "arm") << "it moves that one's arm";
    EXPECT_THAT(watches_.usedServers(), ElementsAre(Pair("arm", "move")));
}

TEST_F(WatchedServers, ShowTheStateThatASkillHadBefore) {
    ArmByHand arm;
    auto& server = arm.bench();
    arm.serve();
    {
        const auto client = system_tests::connectAs(arm.url(), "another");
        ASSERT_TRUE(client->call(server.node("MoveSkill"), server.node("MoveSkill", "Halt")));
    }
    watch({.name = "arm", .url = arm.url()});
    const auto state = board_.skill(keyOf("arm", "MoveSkill")).value();
    EXPECT_EQ(state.state, "Halted");
    EXPECT_GT(state.since, 0.0);
    EXPECT_EQ(board_.skill(keyOf("arm", "TurnSkill"))->state, "Ready");
    EXPECT_EQ(board_.skill(keyOf("arm", "TurnSkill"))->since, 0.0) << "it never changed";
}

TEST_F(WatchedServers, HaveAGripperWithTheStrokeThatTheyPublish) {
    ArmByHand gripper({}, 0.11);
    gripper.serve();
    watch({.name = "gripper",
           .url = gripper.url(),
           .gripper = GripperMount{"ur5", Frame{0, 0, 0.15, 0, 0, 0}}});
    const auto shown = serverOf("gripper").at("gripper");
    EXPECT_EQ(shown.at("arm"), "ur5");
    EXPECT_EQ(shown.at("frame"), json::array({0, 0, 0.15, 0, 0, 0}));
    EXPECT_EQ(shown.at("stroke"), 0.11);
}

}  // namespace
}  // namespace metier::dashboard
