#include "host/server_limits.hpp"

#include <gmock/gmock.h>

#include <cstring>

namespace metier::server {
namespace {

using namespace std::chrono_literals;

bool same(const opcua::ServerLimits& left, const opcua::ServerLimits& right) {
    return std::memcmp(&left, &right, sizeof(left)) == 0;
}

TEST(ServerLimits, AreThoseOfTheCellFileAndElseTheServersOwn) {
    const auto limits = limitsOf({{"sessions", 20}, {"session_timeout", 7.5}, {"event_queue", 5}});
    EXPECT_EQ(limits.sessions, 20);
    EXPECT_EQ(limits.session_timeout, 7500ms);
    EXPECT_EQ(limits.event_queue, 5U);
    EXPECT_EQ(limits.nodes_per_call, opcua::ServerLimits().nodes_per_call);
}

TEST(ServerLimits, EachThatACellFileMaySetIsOneOfTheServers) {
    for (const auto& kind : cell::limitKinds()) {
        const std::string name(kind.name);
        EXPECT_FALSE(same(limitsOf({{name, kind.least}}), limitsOf({{name, kind.most}}))) << name;
    }
}

TEST(ServerLimits, OfSessionsBringAsManyConnectionsWithThem) {
    EXPECT_EQ(limitsOf({{"sessions", 1000}}).secure_channels, 1000);
    EXPECT_EQ(limitsOf({{"sessions", 10}}).secure_channels, opcua::ServerLimits().secure_channels);
}

}  // namespace
}  // namespace metier::server
