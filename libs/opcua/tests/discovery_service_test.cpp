// A server as a Local Discovery Server, and those that register there.
#include "metier/opcua/discovery.hpp"

#include <gmock/gmock.h>

#include <algorithm>

#include "client_bare_server.hpp"
#include "metier/opcua/server.hpp"

namespace metier::opcua::testing {
namespace {

using namespace std::chrono_literals;
using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class DiscoveryServer : public ::testing::Test {
protected:
    DiscoveryServer() {
        ServerOptions options;
        options.application_uri = "urn:metier:test:lds";
        options.port = 0;
        options.discovery = DiscoveryService{.forget_after = kForgetAfter};
        server_ = Server::create(std::move(options)).value();
        EXPECT_TRUE(server_->start());
    }

    static constexpr auto kForgetAfter = 3s;

    static ServerRegistration arm(const std::string& name) {
        return {.application_uri = "urn:metier:test:" + name,
                .name = name,
                .discovery_urls = {"opc.tcp://127.0.0.1:1"}};
    }
    Answer<> tell(const ServerRegistration& registration) const {
        return registerServer(server_->endpointUrl(), registration);
    }
    std::vector<ServerDescription> others() const {
        auto servers = findServers(server_->endpointUrl()).value();
        std::erase_if(servers, [](const ServerDescription& server) {
            return server.type == ApplicationType::discovery_server;
        });
        return servers;
    }

    std::unique_ptr<Server> server_;
};

TEST_F(DiscoveryServer, TellsOfTheServersThatRegistered) {
    ASSERT_TRUE(tell(arm("ur5")));
    ASSERT_TRUE(tell(arm("ur5"))) << "again, as each half minute";
    const auto known = others();
    ASSERT_EQ(known.size(), 1U);
    EXPECT_EQ(known.front().application_uri, "urn:metier:test:ur5");
    EXPECT_EQ(known.front().application_name.text, "ur5");
    EXPECT_EQ(known.front().type, ApplicationType::server);
    EXPECT_THAT(known.front().discovery_urls, ElementsAre("opc.tcp://127.0.0.1:1"));
}

TEST_F(DiscoveryServer, TellsOfItselfAsADiscoveryServer) {
    const auto servers = findServers(server_->endpointUrl()).value();
    ASSERT_EQ(servers.size(), 1U);
    EXPECT_EQ(servers.front().type, ApplicationType::discovery_server);
}

TEST_F(DiscoveryServer, ForgetsAServerThatTakesItselfOut) {
    auto registration = arm("ur5");
    ASSERT_TRUE(tell(registration));
    registration.presence = ServerRegistration::Presence::offline;
    ASSERT_TRUE(tell(registration));
    EXPECT_THAT(others(), IsEmpty());
}

TEST_F(DiscoveryServer, ForgetsAServerThatDoesNotRenew) {
    ASSERT_TRUE(tell(arm("dead")));
    const auto deadline = std::chrono::steady_clock::now() + 30s;
    while (!others().empty()) {
        ASSERT_LT(std::chrono::steady_clock::now(), deadline);
        const auto told = std::chrono::steady_clock::now();
        ASSERT_TRUE(tell(arm("alive")));
        const auto known = others();
        const bool in_time = std::chrono::steady_clock::now() - told < kForgetAfter / 2;
        ASSERT_TRUE(!in_time ||
                    std::any_of(known.begin(), known.end(), [](const ServerDescription& server) {
                        return server.application_name.text == "alive";
                    }));
        if (in_time && known.size() == 1) {
            return;  // the other one is forgotten
        }
    }
}

TEST_F(DiscoveryServer, RefusesAServerWithoutAnAddress) {
    auto registration = arm("nowhere");
    registration.discovery_urls.clear();
    EXPECT_FALSE(tell(registration));
    EXPECT_THAT(others(), IsEmpty());
}

TEST(RegisterServer, IsRefusedByAServerThatIsNone) {
    const BareServer server;
    const auto told = registerServer(
        server.url(), {.application_uri = "urn:a", .name = "a", .discovery_urls = {"opc.tcp://a"}});
    ASSERT_FALSE(told);
    EXPECT_EQ(told.error().status, status::kBadServiceUnsupported);
}

TEST(RegisterServer, EndsAtItsDeadlineWhenNobodyAnswers) {
    const MuteListener listener;
    const auto told = registerServer(
        listener.url(),
        {.application_uri = "urn:a", .name = "a", .discovery_urls = {"opc.tcp://a"}}, 100ms);
    ASSERT_FALSE(told);
    EXPECT_EQ(told.error().status, status::kBadTimeout);
}

TEST(DiscoveryServerOptions, RefuseRegistrationsThatEndAtOnce) {
    ServerOptions options;
    options.discovery = DiscoveryService{.forget_after = 0s};
    EXPECT_EQ(Server::create(options).error().code, Errc::invalid_argument);
}

}  // namespace
}  // namespace metier::opcua::testing
