#include <gmock/gmock.h>

#include "event_loop_testing.hpp"

namespace metier::opcua::testing {

namespace {

constexpr std::size_t kStreamedEvents = 2000;
constexpr int kManyFlushes = 2000;
// Far below the publishing interval of these tests, also on a machine that may make it wait.
constexpr auto kAtOnce = 5s;

/// A client that is connected and subscribed to events.
std::unique_ptr<TestClient> subscribed(TestServer& server, TestClient::SubscriptionOptions options,
                                       LoopKind kind = LoopKind::ours) {
    auto client = std::make_unique<TestClient>(kind);
    if (client->connect(server.url()) != UA_STATUSCODE_GOOD) {
        throw std::runtime_error("no connection");
    }
    client->subscribe(options);
    return client;
}

UA_StatusCode modify(TestClient& client, UA_UInt32 id, TestClient::SubscriptionOptions to) {
    UA_ModifySubscriptionRequest request;
    UA_ModifySubscriptionRequest_init(&request);
    request.subscriptionId = id;
    request.requestedPublishingInterval = to.publishing_interval_ms;
    request.requestedLifetimeCount = to.lifetime_count;
    request.requestedMaxKeepAliveCount = to.keep_alive_count;
    return UA_Client_Subscriptions_modify(client.get(), request).responseHeader.serviceResult;
}

TEST(EventLoopPublishing, BringsAnEventAtOnceWhateverThePublishingInterval) {
    TestServer server;
    const auto client = subscribed(server, {.publishing_interval_ms = 10'000});
    for (std::size_t i = 0; i < 200; ++i) {
        const auto start = std::chrono::steady_clock::now();
        ASSERT_TRUE(client->fire());
        ASSERT_TRUE(client->runUntil([&] { return client->events().size() > i; }));
        ASSERT_LT(client->events().back() - start, kAtOnce);
    }
}

TEST(EventLoopPublishing, BringsEventsFiredOutsideOfACallAtOnceToEveryClient) {
    TestServer server;
    std::vector<std::unique_ptr<TestClient>> clients;
    for (const auto kind : {LoopKind::ours, LoopKind::stock, LoopKind::ours}) {
        clients.push_back(subscribed(server, {.publishing_interval_ms = 10'000}, kind));
    }
    for (std::size_t i = 0; i < 20; ++i) {
        const auto start = std::chrono::steady_clock::now();
        server.inServer([&](UA_Server*) { server.fire(); });
        for (auto& client : clients) {
            ASSERT_TRUE(client->runUntil([&] { return client->events().size() > i; }));
        }
        ASSERT_LT(std::chrono::steady_clock::now() - start, kAtOnce);
    }
}

TEST(EventLoopPublishing, ServesEverySubscriptionOfAConnection) {
    TestServer server;
    const auto client = subscribed(server, {.publishing_interval_ms = 10'000});
    client->subscribe({.publishing_interval_ms = 20'000});
    client->subscribe({.publishing_interval_ms = 30'000});
    for (std::size_t i = 1; i <= 20; ++i) {
        ASSERT_TRUE(client->fire());
        ASSERT_TRUE(client->runUntil([&] { return client->events().size() == 3 * i; }));
    }
}

TEST(EventLoopPublishing, PublishesOnceForManyEventsOfOneIteration) {
    TestServer server;
    const auto client = subscribed(server, {.publishing_interval_ms = 10'000});
    ASSERT_TRUE(client->fire());
    ASSERT_TRUE(client->runUntil([&] { return client->events().size() == 1; }));
    const auto before = server.statistics().flushes;
    server.inServer([&](UA_Server*) {
        for (int i = 0; i < 50; ++i) {
            server.fire();
        }
    });
    ASSERT_TRUE(client->runUntil([&] { return client->events().size() == 51; }));
    EXPECT_EQ(server.statistics().flushes - before, 1);
}

TEST(EventLoopPublishing, DeliversEveryEventOfAFastStreamInOrder) {
    TestServer server;
    const auto client = subscribed(server, {.publishing_interval_ms = 10'000});
    for (std::size_t i = 0; i < kStreamedEvents; ++i) {  // faster than PublishRequests come back
        server.loop().post([&] { server.fire(); });
        if (i % 100 == 99) {
            ASSERT_TRUE(client->runUntil([&] { return client->events().size() == i + 1; }));
        }
    }
    EXPECT_EQ(client->events().size(), kStreamedEvents);
}

TEST(EventLoopPublishing, DoesNotWearOutAnIdleSubscription) {
    TestServer server;
    const auto client = subscribed(
        server, {.publishing_interval_ms = 10'000, .lifetime_count = 30, .keep_alive_count = 10});
    ASSERT_TRUE(client->fire());
    ASSERT_TRUE(client->runUntil([&] { return client->events().size() == 1; }));
    const auto start = std::chrono::steady_clock::now();
    for (int i = 0; i < kManyFlushes; ++i) {
        server.inServer([&](UA_Server*) { server.flushAll(); });
    }
    const auto most = 20 + (std::chrono::steady_clock::now() - start) / 100ms;
    EXPECT_LE(server.statistics().fruitless_flushes, most) << "100 ms of rest between them";
    ASSERT_TRUE(client->fire());
    ASSERT_TRUE(client->runUntil([&] { return client->events().size() == 2; }));
    EXPECT_EQ(client->deleted(), 0);
}

TEST(EventLoopPublishing, LeavesASubscriptionWithoutPublishRequestsAlone) {
    TestServer server;
    TestClient client;
    UA_Client_getConfig(client.get())->outStandingPublishRequests = 0;
    ASSERT_EQ(client.connect(server.url()), UA_STATUSCODE_GOOD);
    client.subscribe(
        {.publishing_interval_ms = 100'000, .lifetime_count = 3, .keep_alive_count = 1});
    for (int i = 0; i < 100; ++i) {
        ASSERT_TRUE(client.fire());
    }
    for (int i = 0; i < kManyFlushes; ++i) {
        server.inServer([&](UA_Server*) { server.flushAll(); });
    }
    EXPECT_EQ(server.statistics().flushes, 0);
    UA_Client_getConfig(client.get())->outStandingPublishRequests = 5;
    client.subscribe({.events = false});  // sends PublishRequests again
    ASSERT_TRUE(client.runUntil([&] { return client.events().size() == 100; }));
}

TEST(EventLoopPublishing, SurvivesASubscriptionThatEndsInItsOwnCallback) {
    TestServer server;
    TestClient client;
    UA_Client_getConfig(client.get())->outStandingPublishRequests = 0;
    ASSERT_EQ(client.connect(server.url()), UA_STATUSCODE_GOOD);
    // It lives until it has its MonitoredItem, and not for long then.
    const auto id = client.subscribe(
        {.publishing_interval_ms = 100'000, .lifetime_count = 3, .keep_alive_count = 1});
    ASSERT_EQ(modify(client, id,
                     {.publishing_interval_ms = 5, .lifetime_count = 3, .keep_alive_count = 1}),
              UA_STATUSCODE_GOOD);
    const auto count = [](UA_Server* native) {
        return UA_Server_getStatistics(native).ss.currentSessionCount;
    };
    ASSERT_EQ(server.inServer(count), 1);
    const auto subscriptions = [&] {
        return server.inServer([](UA_Server* native) { return subscriptionCount(native); });
    };
    ASSERT_TRUE(client.runUntil([&] { return subscriptions() == 0; }));
    server.inServer([&](UA_Server*) { server.fire(); });
    EXPECT_EQ(client.echo("alive"), "alive");
}

TEST(EventLoopPublishing, ForgetsDeletedSubscriptionsAndClosedConnections) {
    TestServer server;
    {
        TestClient client;
        ASSERT_EQ(client.connect(server.url()), UA_STATUSCODE_GOOD);
        const auto id = client.subscribe({.publishing_interval_ms = 10'000});
        UA_Client_Subscriptions_deleteSingle(client.get(), id);
        ASSERT_TRUE(client.fire());
        client.subscribe({.publishing_interval_ms = 10'000});
    }
    const auto again = subscribed(server, {.publishing_interval_ms = 10'000});
    server.inServer([&](UA_Server*) { server.fire(); });
    ASSERT_TRUE(again->runUntil([&] { return again->events().size() == 1; }));
}

TEST(EventLoopPublishing, FollowsASubscriptionWhoseIntervalIsModified) {
    TestServer server;
    TestClient client;
    ASSERT_EQ(client.connect(server.url()), UA_STATUSCODE_GOOD);
    const auto id = client.subscribe({.publishing_interval_ms = 100});
    ASSERT_EQ(modify(client, id, {.publishing_interval_ms = 20'000, .lifetime_count = 100}),
              UA_STATUSCODE_GOOD);
    ASSERT_TRUE(client.fire());
    ASSERT_TRUE(client.runUntil([&] { return client.events().size() == 1; }));
}

}  // namespace

}  // namespace metier::opcua::testing
