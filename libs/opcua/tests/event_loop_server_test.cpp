#include <gmock/gmock.h>

#include <filesystem>

#include "event_loop_testing.hpp"

namespace metier::opcua::testing {

namespace {

using ::testing::HasSubstr;

std::size_t openFiles() {
    const std::filesystem::directory_iterator files("/proc/self/fd");
    return static_cast<std::size_t>(std::distance(begin(files), end(files)));
}

/// A port on which nobody listens: it was used a moment ago.
std::uint16_t freePort() {
    return TestServer().port();
}

TEST(EventLoopServer, ServesCallsOfOurClientAndOfTheStacks) {
    TestServer server;
    for (const auto kind : {LoopKind::ours, LoopKind::stock}) {
        TestClient client(kind);
        ASSERT_EQ(client.connect(server.url()), UA_STATUSCODE_GOOD);
        EXPECT_EQ(client.echo("hello"), "hello");
    }
}

TEST(EventLoopServer, OurClientTalksToAServerOnTheStacksLoop) {
    TestServer server({.port = freePort(), .kind = LoopKind::stock});
    ASSERT_EQ(server.started(), UA_STATUSCODE_GOOD);
    TestClient client;
    ASSERT_EQ(client.connect(server.url()), UA_STATUSCODE_GOOD);
    EXPECT_EQ(client.echo("hello"), "hello");
}

TEST(EventLoopServer, CarriesMessagesOfManyChunks) {
    TestServer server;
    TestClient client;
    ASSERT_EQ(client.connect(server.url()), UA_STATUSCODE_GOOD);
    const std::string big(3'000'000, 'm');
    EXPECT_EQ(client.echo(big), big);
}

TEST(EventLoopServer, AClientFailsToConnectToAClosedPortWithinItsDeadline) {
    const auto port = freePort();
    TestClient client;
    const auto start = std::chrono::steady_clock::now();
    EXPECT_NE(client.connect("opc.tcp://127.0.0.1:" + std::to_string(port)), UA_STATUSCODE_GOOD);
    EXPECT_LT(std::chrono::steady_clock::now() - start, kDeadline);
}

TEST(EventLoopServer, RestartsAtOnceOnItsPortThoughClientsWereConnected) {
    auto first = std::make_unique<TestServer>();
    const auto port = first->port();
    TestClient client;
    ASSERT_EQ(client.connect(first->url()), UA_STATUSCODE_GOOD);
    first.reset();
    TestServer second({.port = port});
    ASSERT_EQ(second.started(), UA_STATUSCODE_GOOD);
    TestClient again;
    ASSERT_EQ(again.connect(second.url()), UA_STATUSCODE_GOOD);
    EXPECT_EQ(again.echo("back"), "back");
}

TEST(EventLoopServer, ASecondServerOnTheSamePortDoesNotStart) {
    TestServer first;
    TestServer second({.port = first.port()});
    EXPECT_NE(second.started(), UA_STATUSCODE_GOOD);
    EXPECT_THAT(second.loop().lastNetworkError(), HasSubstr("Address already in use"));
    TestClient client;
    EXPECT_EQ(client.connect(first.url()), UA_STATUSCODE_GOOD);
}

TEST(EventLoopServer, TwoHundredConnectionsLeaveNothingBehind) {
    TestServer server;
    const auto before = openFiles();
    for (int i = 0; i < 200; ++i) {
        TestClient client;
        ASSERT_EQ(client.connect(server.url()), UA_STATUSCODE_GOOD);
    }
    const auto deadline = std::chrono::steady_clock::now() + kDeadline;
    while (server.statistics().connections > 0 && std::chrono::steady_clock::now() < deadline) {
    }
    EXPECT_EQ(server.statistics().connections, 0);
    EXPECT_GE(server.statistics().accepted, 200);
    EXPECT_EQ(openFiles(), before);
}

TEST(EventLoopServer, SharesItsLoopWithAClient) {
    AsioEventLoop loop;
    UA_ServerConfig server_config{};
    server_config.eventLoop = loop.handle();
    UA_ServerConfig_setMinimal(&server_config, 0, nullptr);
    auto* server = UA_Server_newWithConfig(&server_config);
    ASSERT_EQ(UA_Server_run_startup(server), UA_STATUSCODE_GOOD);

    UA_ClientConfig client_config{};
    client_config.eventLoop = loop.handle();
    client_config.externalEventLoop = true;
    UA_ClientConfig_setDefault(&client_config);
    auto* client = UA_Client_newWithConfig(&client_config);
    const auto url = "opc.tcp://127.0.0.1:" + std::to_string(loop.listening().front().port);
    EXPECT_EQ(UA_Client_connect(client, url.c_str()), UA_STATUSCODE_GOOD);
    UA_Client_delete(client);

    EXPECT_EQ(UA_Server_run_shutdown(server), UA_STATUSCODE_GOOD);
    EXPECT_EQ(UA_Server_delete(server), UA_STATUSCODE_GOOD);
    EXPECT_EQ(loop.statistics().connections, 0);
}

TEST(EventLoopServer, CutsAClientThatNeverReadsAndServesOthersMeanwhile) {
    TestServer server({.loop = {.send_queue_limit = 1U << 20U, .kernel_send_buffer = 8192}});
    TestClient deaf(LoopKind::stock);  // its sends wait until the server took them
    ASSERT_EQ(deaf.connect(server.url()), UA_STATUSCODE_GOOD);
    TestClient other;
    ASSERT_EQ(other.connect(server.url()), UA_STATUSCODE_GOOD);
    const std::string text(60'000, 'd');
    const auto deadline = std::chrono::steady_clock::now() + kDeadline;
    int calls = 0;
    int at_once = 0;
    while (server.statistics().cut_peers == 0 && std::chrono::steady_clock::now() < deadline) {
        deaf.askForEcho(text);
        const auto start = std::chrono::steady_clock::now();
        ASSERT_EQ(other.echo("alive"), "alive");
        ++calls;
        at_once += std::chrono::steady_clock::now() - start < 500ms ? 1 : 0;
    }
    EXPECT_EQ(server.statistics().cut_peers, 1);
    EXPECT_EQ(other.echo("alive"), "alive");
    EXPECT_GT(2 * at_once, calls) << "a server that waits for the deaf one answers late each time";
}

}  // namespace

}  // namespace metier::opcua::testing
