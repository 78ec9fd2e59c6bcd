#include "host/announcement.hpp"

#include <gmock/gmock.h>

#include "lab.hpp"
#include "metier/base/queue.hpp"
#include "metier/opcua/search.hpp"
#include "metier/server/discovery_server.hpp"

namespace metier::server::testing {
namespace {

using ::testing::ElementsAre;
using ::testing::Field;
using ::testing::HasSubstr;
using ::testing::MatchesRegex;

cell::ServerConfig serverAt(std::uint16_t port) {
    cell::ServerConfig config;
    config.name = "ur5";
    config.address = "127.0.0.1";
    config.port = port;
    return config;
}

TEST(AnnouncedUrl, IsWhereTheServerListensUnlessOthersReachItByAnotherHost) {
    cell::Discovery discovery;
    EXPECT_EQ(announcedUrl(discovery, "opc.tcp://127.0.0.1:4841"), "opc.tcp://127.0.0.1:4841");
    discovery.announce_as = "robot.example";
    EXPECT_EQ(announcedUrl(discovery, "opc.tcp://127.0.0.1:4841"), "opc.tcp://robot.example:4841");
}

TEST(ApplicationUri, StaysTheSameAtAPortOfItsOwn) {
    auto config = serverAt(4841);
    EXPECT_EQ(applicationUriOf(config), applicationUriOf(config));
    EXPECT_THAT(applicationUriOf(config), MatchesRegex("urn:.+:metier:ur5:4841"));
    config.discovery.announce_as = "robot.example";
    EXPECT_EQ(applicationUriOf(config), "urn:robot.example:metier:ur5:4841");
}

TEST(ApplicationUri, IsAnotherEachTimeAtAnyFreePort) {
    EXPECT_NE(applicationUriOf(serverAt(0)), applicationUriOf(serverAt(0)));
}

class AnnouncedServer : public Lab {
protected:
    AnnouncedServer()
        : discovery_(DiscoveryServer::start({.port = 0, .forget_after = std::chrono::seconds(1)},
                                            identity_)
                         .value()) {}

    cell::Discovery discovery() const {
        cell::Discovery discovery;
        discovery.servers = {discovery_->url()};
        discovery.period = 0.2;
        return discovery;
    }
    /// Names of the servers that are known, once there are so many; what there is after a minute.
    std::vector<std::string> awaitKnown(std::size_t count) const {
        std::vector<std::string> names;
        Queue<int> nothing(1);
        do {
            static_cast<void>(
                nothing.popUntil(std::chrono::steady_clock::now() + std::chrono::milliseconds(50)));
            names.clear();
            for (const auto& server : opcua::askDiscoveryServers({discovery_->url()}).servers) {
                names.push_back(server.name + " " + server.url);
            }
        } while (names.size() != count && std::chrono::steady_clock::now() < deadline_);
        return names;
    }

    const SteadyTime deadline_ = inAMinute();
    std::unique_ptr<DiscoveryServer> discovery_;
};

TEST_F(AnnouncedServer, IsKnownWhileItServes) {
    {
        auto config = serverAt(4841);
        config.discovery = discovery();
        const Announcement announcement(config, identity_, "urn:test:ur5",
                                        "opc.tcp://127.0.0.1:4841");
        EXPECT_THAT(awaitKnown(1), ElementsAre("ur5 opc.tcp://127.0.0.1:4841"));
    }
    EXPECT_THAT(awaitKnown(0), ElementsAre());
}

TEST_F(AnnouncedServer, IsKnownByTheHostThatItsCellFileNames) {
    auto config = serverAt(4841);
    config.discovery = discovery();
    config.discovery.announce_as = "robot.example";
    const Announcement announcement(config, identity_, "urn:test:ur5", "opc.tcp://127.0.0.1:4841");
    EXPECT_THAT(awaitKnown(1), ElementsAre("ur5 opc.tcp://robot.example:4841"));
}

TEST_F(AnnouncedServer, ServesThoughNobodyIsThereToKnowIt) {
    auto arm = config("ur5", streamedUr());
    arm.discovery.servers = {"opc.tcp://127.0.0.1:1"};
    EXPECT_TRUE(serve(arm));
}

TEST_F(AnnouncedServer, IsRefusedADiscoveryServerAtAPortThatIsTaken) {
    const auto url = discovery_->url();
    const auto port = static_cast<std::uint16_t>(std::stoi(url.substr(url.rfind(':') + 1)));
    EXPECT_FALSE(DiscoveryServer::start({.port = port}, identity_));
}

}  // namespace
}  // namespace metier::server::testing
