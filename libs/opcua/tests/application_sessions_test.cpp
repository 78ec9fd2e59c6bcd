#include "server/application_sessions.hpp"

#include <gtest/gtest.h>

namespace metier::opcua {
namespace {

using namespace std::chrono_literals;

const SteadyTime kStart{1000s};
const ApplicationSessions::Application kGateway{"aa11", "urn:gateway"};
const ApplicationSessions::Application kPanel{"bb22", "urn:panel"};

TEST(ApplicationSessions, AreAsManyAsEachApplicationMayHave) {
    ApplicationSessions sessions(2, 10s);
    EXPECT_TRUE(sessions.create(kGateway, kStart));
    sessions.activated("aa11");
    EXPECT_TRUE(sessions.create(kGateway, kStart));
    EXPECT_FALSE(sessions.create(kGateway, kStart));
    EXPECT_TRUE(sessions.create(kPanel, kStart));
    EXPECT_EQ(sessions.of("aa11"), 2U);
    EXPECT_EQ(sessions.of("bb22"), 1U);
}

TEST(ApplicationSessions, AreFreeAgainOnceTheyAreClosed) {
    ApplicationSessions sessions(1, 10s);
    ASSERT_TRUE(sessions.create(kGateway, kStart));
    sessions.activated("aa11");
    sessions.closed("bb22");
    EXPECT_FALSE(sessions.create(kGateway, kStart));
    sessions.closed("aa11");
    EXPECT_TRUE(sessions.create(kGateway, kStart));
}

TEST(ApplicationSessions, CountAlsoIfTheyAreOnlyCreatedUntilTheyAreGone) {
    ApplicationSessions sessions(1, 10s);
    ASSERT_TRUE(sessions.create(kGateway, kStart));
    sessions.abandoned("urn:panel");
    EXPECT_FALSE(sessions.create(kGateway, kStart));
    sessions.abandoned("urn:gateway");
    EXPECT_TRUE(sessions.create(kGateway, kStart));
}

TEST(ApplicationSessions, ThatTheStackNeverMadeAreForgotten) {
    ApplicationSessions sessions(1, 10s);
    ASSERT_TRUE(sessions.create(kGateway, kStart));
    EXPECT_FALSE(sessions.create(kGateway, kStart + 10s - 1ns));
    EXPECT_TRUE(sessions.create(kGateway, kStart + 10s));
}

}  // namespace
}  // namespace metier::opcua
