#include <gmock/gmock.h>

#include "client_bare_server.hpp"
#include "metier/opcua/discovery.hpp"

namespace metier::opcua::testing {
namespace {

using namespace std::chrono_literals;
using ::testing::Contains;
using ::testing::HasSubstr;

TEST(ClientDiscovery, ListsTheEndpointsOfAServer) {
    const BareServer server;
    const auto endpoints = getEndpoints(server.url());
    ASSERT_TRUE(endpoints) << endpoints.error().message;
    ASSERT_FALSE(endpoints->empty());
    const auto& first = endpoints->front();
    EXPECT_EQ(first.security_mode, EndpointDescription::SecurityMode::none);
    EXPECT_THAT(first.security_policy_uri, HasSubstr("#None"));
    EXPECT_THAT(first.tokens, Contains(EndpointDescription::TokenType::anonymous));
}

TEST(ClientDiscovery, ListsTheServersThatAServerKnows) {
    const BareServer server;
    const auto servers = findServers(server.url());
    ASSERT_TRUE(servers) << servers.error().message;
    ASSERT_EQ(servers->size(), 1U);
    EXPECT_FALSE(servers->front().application_uri.empty());
}

TEST(ClientDiscovery, EndsAtItsDeadlineWhenNobodyAnswers) {
    const MuteListener listener;
    const auto endpoints = getEndpoints(listener.url(), 100ms);
    ASSERT_FALSE(endpoints);
    EXPECT_EQ(endpoints.error().status, status::kBadTimeout);
}

TEST(ClientDiscovery, SaysThatNobodyIsThere) {
    const auto endpoints = getEndpoints("opc.tcp://127.0.0.1:1");
    ASSERT_FALSE(endpoints);
    EXPECT_EQ(endpoints.error().code, Errc::connection_lost);
}

}  // namespace
}  // namespace metier::opcua::testing
