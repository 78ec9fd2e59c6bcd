#include "metier/opcua/server.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <spdlog/sinks/ostream_sink.h>

#include <condition_variable>
#include <mutex>
#include <semaphore>
#include <sstream>
#include <thread>

#include "bare_client.hpp"
#include "metier/opcua/discovery.hpp"

namespace metier::opcua {
namespace {

using testing::BareClient;
using ::testing::HasSubstr;
using testing::kDeadline;
using testing::makeServer;
using testing::testOptions;
using ::testing::UnorderedElementsAre;
using namespace std::chrono_literals;

TEST(Server, ServesClientsOnAFreePort) {
    const auto server = makeServer();
    EXPECT_EQ(server->endpointUrl(), "");
    ASSERT_TRUE(server->start());
    EXPECT_EQ(server->endpointUrl(), "opc.tcp://127.0.0.1:" + std::to_string(server->port()));
    BareClient client;
    EXPECT_EQ(client.connect(server->endpointUrl()), status::kGood);
    EXPECT_EQ(client.read(NodeId(0, 2259U)).value.as<std::int32_t>(), 0);  // ServerState Running
}

TEST(Server, TellsItsPortIsTaken) {
    const auto first = makeServer();
    ASSERT_TRUE(first->start());
    auto options = testOptions();
    options.port = first->port();
    const auto second = makeServer(options);
    const auto started = second->start();
    ASSERT_FALSE(started);
    EXPECT_EQ(started.error().code, Errc::already_exists);
    EXPECT_THAT(started.error().message, HasSubstr(std::to_string(first->port())));
}

TEST(Server, TakesItsPortAgainAfterARestart) {
    auto options = testOptions();
    BareClient client;
    for (int round = 0; round < 3; ++round) {
        const auto server = makeServer(options);
        ASSERT_TRUE(server->start());
        options.port = server->port();
        ASSERT_EQ(client.connect(server->endpointUrl()), status::kGood);
    }
}

TEST(Server, StartsOnlyOnce) {
    const auto server = makeServer();
    ASSERT_TRUE(server->start());
    EXPECT_EQ(server->start().error().code, Errc::invalid_state);
}

TEST(Server, RefusesAddressesThatAreNotLoopback) {
    auto options = testOptions();
    options.bind_addresses = {"127.0.0.1", "192.168.0.7"};
    const auto server = Server::create(options);
    ASSERT_FALSE(server);
    EXPECT_EQ(server.error().code, Errc::invalid_argument);
    EXPECT_THAT(server.error().message, HasSubstr("192.168.0.7"));
}

TEST(Server, RefusesAFreePortOnSeveralAddresses) {
    auto options = testOptions();
    options.bind_addresses = {"127.0.0.1", "127.0.0.2"};
    EXPECT_EQ(Server::create(options).error().code, Errc::invalid_argument);
}

TEST(Server, RefusesMoreSessionsThanChannels) {
    auto options = testOptions();
    options.limits.sessions = 200;
    EXPECT_EQ(Server::create(options).error().code, Errc::invalid_argument);
}

TEST(Server, RefusesANodeSetItDoesNotHave) {
    auto options = testOptions();
    options.nodesets = {"no_such_robot"};
    const auto server = Server::create(options);
    ASSERT_FALSE(server);
    EXPECT_EQ(server.error().code, Errc::not_found);
    EXPECT_THAT(server.error().message, HasSubstr("no_such_robot"));
}

TEST(Server, LoadsTheSkillModelAndARobot) {
    auto options = testOptions();
    options.nodesets = {"iiwa"};
    const auto server = makeServer(options);
    const auto& nodes = server->nodes();
    const auto device = nodes.namespaceIndex("https://fortiss.org/UA/Device/");
    ASSERT_TRUE(device);
    EXPECT_TRUE(nodes.exists(NodeId(*device, 15002U)) || nodes.exists(NodeId(*device, 15001U)));
    EXPECT_TRUE(nodes.namespaceIndex("https://fortiss.org/UA/iiwa/"));
    EXPECT_FALSE(nodes.namespaceIndex("https://fortiss.org/UA/edo/"));
    EXPECT_GT(*nodes.namespaceIndex("urn:metier:test:a"),
              *nodes.namespaceIndex("https://fortiss.org/UA/iiwa/"));
}

/// User and role under which a Method sees its caller.
struct Caller {
    std::string user = "nobody";
    security::Role role = security::Role::observer;
};

Caller callerSeenAs(const std::string& user, const std::string& password) {
    const auto server = makeServer();
    Caller seen;
    const NodeId method(2, "Who");
    EXPECT_TRUE(server->nodes().addMethod(
        {.node = {method, ids::kObjectsFolder, ids::kHasComponent, {2, "Who"}},
         .handler = [&](const CallContext& context,
                        std::span<const Value>) -> Result<std::vector<Value>> {
             seen = {context.session.user, context.session.role};
             return std::vector<Value>();
         }}));
    EXPECT_TRUE(server->start());
    BareClient client;
    EXPECT_EQ(client.connectAs(user, password, server->endpointUrl()), status::kGood);
    EXPECT_EQ(client.call(ids::kObjectsFolder, method, {}).status, status::kGood);
    client.disconnect();
    return seen;
}

TEST(LabServer, TakesAnyUserForItsAnonymousOne) {
    for (const auto* user : {"line 4", ""}) {
        for (const auto* password : {"whatever", ""}) {
            const auto seen = callerSeenAs(user, password);
            EXPECT_EQ(seen.user, "");
            EXPECT_EQ(seen.role, security::Role::engineer);
        }
    }
}

TEST(LabServer, OffersUserNamesWithoutEncryption) {
    const auto server = makeServer();
    ASSERT_TRUE(server->start());
    const auto endpoints = getEndpoints(server->endpointUrl());
    ASSERT_TRUE(endpoints) << endpoints.error().message;
    ASSERT_EQ(endpoints->size(), 1U);
    EXPECT_THAT(endpoints->front().tokens,
                UnorderedElementsAre(EndpointDescription::TokenType::anonymous,
                                     EndpointDescription::TokenType::user_name));
}

/// Reads a Variable of the Server object as a client.
DataValue readOfServer(std::uint32_t id) {
    const auto server = makeServer();
    EXPECT_TRUE(server->start());
    BareClient client;
    EXPECT_EQ(client.connect(server->endpointUrl()), status::kGood);
    auto value = client.read(NodeId(0, id));
    client.disconnect();
    return value;
}

TEST(Server, SaysWhichProductAndVersionItIs) {
    EXPECT_EQ(readOfServer(2261).value, Value::of("metier"));        // ProductName
    EXPECT_EQ(readOfServer(2262).value, Value::of("urn:metier"));    // ProductUri
    EXPECT_EQ(readOfServer(2263).value, Value::of("metier"));        // ManufacturerName
    EXPECT_EQ(readOfServer(2264).value, Value::of(METIER_VERSION));  // SoftwareVersion
    EXPECT_EQ(readOfServer(2265).value, Value::of(METIER_VERSION));  // BuildNumber
}

TEST(Server, ClaimsTheProfilesThatItHas) {
    const auto profiles = readOfServer(2269).value.as<std::vector<std::string>>();
    ASSERT_TRUE(profiles);
    EXPECT_THAT(*profiles,
                UnorderedElementsAre(
                    "http://opcfoundation.org/UA-Profile/Server/MicroEmbeddedDevice2017",
                    "http://opcfoundation.org/UA-Profile/Server/Methods",
                    "http://opcfoundation.org/UA-Profile/Server/StandardEventSubscription"));
}

TEST(Server, SaysLoudlyThatItIsInsecure) {
    std::ostringstream log;
    auto options = testOptions();
    options.logger = std::make_shared<spdlog::logger>(
        "loud", std::make_shared<spdlog::sinks::ostream_sink_mt>(log));
    {
        const auto server = makeServer(options);
        ASSERT_TRUE(server->start());
    }
    EXPECT_THAT(log.str(), HasSubstr("INSECURE LAB"));
}

TEST(Server, GivesEachNamespaceAnIndexInOrder) {
    const auto server = makeServer();
    EXPECT_EQ(server->nodes().namespaceIndex("urn:metier:test:a"), 2);
    EXPECT_EQ(server->nodes().namespaceIndex("urn:metier:test:b"), 3);
    EXPECT_EQ(server->nodes().namespaceIndex("urn:none").error().code, Errc::not_found);
}

TEST(Server, LetsNoClientChangeTheAddressSpace) {
    const auto server = makeServer();
    ASSERT_TRUE(server->start());
    BareClient client;
    ASSERT_EQ(client.connect(server->endpointUrl()), status::kGood);
    EXPECT_EQ(client.addFolder(ids::kObjectsFolder), status::kBadUserAccessDenied);
}

TEST(ServerThread, RunsPostedWorkInOrder) {
    const auto server = makeServer();
    std::vector<int> order;
    server->post([&] { order.push_back(1); });
    ASSERT_TRUE(server->start());
    server->post([&] { order.push_back(2); });
    const auto seen = server->call([&] { return order; });
    EXPECT_EQ(*seen, (std::vector<int>{1, 2}));
}

TEST(ServerThread, RunsPostedWorkOfManyThreads) {
    const auto server = makeServer();
    ASSERT_TRUE(server->start());
    int count = 0;  // the server's thread only
    constexpr int kThreads = 8;
    constexpr int kEach = 1000;
    const auto post = [&] {
        for (int n = 0; n < kEach; ++n) {
            server->post([&] { ++count; });
        }
        EXPECT_TRUE(server->call([&] { ++count; }));
    };
    {
        std::vector<std::jthread> threads;
        for (int i = 0; i < kThreads; ++i) {
            threads.emplace_back(post);
        }
    }
    EXPECT_EQ(server->call([&] { return count; }), kThreads * (kEach + 1));
}

TEST(ServerThread, CallReturnsResultsAndErrors) {
    const auto server = makeServer();
    ASSERT_TRUE(server->start());
    EXPECT_EQ(server->call([] { return std::string("done"); }), "done");
    const auto refused =
        server->call([]() -> Result<int> { return fail(Errc::locked, "by another"); });
    EXPECT_EQ(refused.error().code, Errc::locked);
    EXPECT_TRUE(server->call([] {}));
    EXPECT_TRUE(*server->call([&] { return server->onServerThread(); }));
    EXPECT_FALSE(server->onServerThread());
}

TEST(ServerThread, CallTurnsAnExceptionIntoAnError) {
    const auto server = makeServer();
    ASSERT_TRUE(server->start());
    const auto failed = server->call([]() -> int { throw std::runtime_error("broken"); });
    EXPECT_EQ(failed.error().code, Errc::internal);
    EXPECT_EQ(failed.error().message, "broken");
}

TEST(ServerThread, AnExceptionOfPostedWorkStopsNothing) {
    const auto server = makeServer();
    ASSERT_TRUE(server->start());
    server->post([] { throw std::runtime_error("lost"); });
    EXPECT_EQ(server->call([] { return 1; }), 1);
}

TEST(ServerThread, WorkThatWasNotBegunAtTheDeadlineNeverIs) {
    const auto server = makeServer();
    ASSERT_TRUE(server->start());
    std::promise<void> release;
    server->post([&] { release.get_future().wait_for(kDeadline); });
    bool ran = false;
    const auto late = server->call([&] { ran = true; }, 10ms);
    EXPECT_EQ(late.error().code, Errc::timeout);
    EXPECT_THAT(late.error().message, HasSubstr("begin within 10 ms"));
    release.set_value();
    ASSERT_TRUE(server->call([] {}));
    EXPECT_FALSE(ran);
}

TEST(ServerThread, CallsOnTheServersThreadRunAtOnce) {
    const auto server = makeServer();
    ASSERT_TRUE(server->start());
    EXPECT_EQ(server->call([&] { return server->call([] { return 5; }); }), 5);
}

TEST(ServerThread, CallsAreCancelledWhenTheServerStopped) {
    const auto server = makeServer();
    ASSERT_TRUE(server->start());
    server->stop();
    std::jthread caller(
        [&] { EXPECT_EQ(server->call([] { return 1; }).error().code, Errc::cancelled); });
}

// The last owner of a timer's handle may be such work.
TEST(ServerThread, WorkThatIsDroppedEndsAfterTheThreadHas) {
    const auto server = makeServer();
    ASSERT_TRUE(server->start());
    std::binary_semaphore begun{0};
    std::binary_semaphore gone{0};
    bool while_working = false;
    server->post([&] {
        begun.release();
        while_working = gone.try_acquire_for(300ms);
    });
    begun.acquire();
    server->post([last = std::shared_ptr<void>(nullptr, [&](void*) { gone.release(); })] {});
    server->stop();
    EXPECT_FALSE(while_working);
    EXPECT_TRUE(gone.try_acquire());
}

TEST(ServerThread, TicksWithoutAnyClient) {
    const auto server = makeServer();
    ASSERT_TRUE(server->start());
    const auto before = server->lastTick();
    std::promise<void> later;
    auto handle = server->call([&] { return server->after(250ms, [&] { later.set_value(); }); });
    ASSERT_EQ(later.get_future().wait_for(kDeadline), std::future_status::ready);
    EXPECT_GT(server->lastTick(), before);
    EXPECT_TRUE(server->call(
        [kept = std::make_shared<TimerHandle>(std::move(*handle))] { kept->cancel(); }));
}

TEST(ServerTimer, RunsOnceAndNotBeforeItsTime) {
    const auto server = makeServer();
    ASSERT_TRUE(server->start());
    std::promise<SteadyTime> fired;
    const auto begin = std::chrono::steady_clock::now();
    auto handle = std::make_shared<TimerHandle>();
    server->post([&, handle] {
        *handle = server->after(20ms, [&] { fired.set_value(std::chrono::steady_clock::now()); });
    });
    auto time = fired.get_future();
    ASSERT_EQ(time.wait_for(kDeadline), std::future_status::ready);
    EXPECT_GE(time.get() - begin, 20ms);
}

TEST(ServerTimer, IsCancelledWithItsHandle) {
    const auto server = makeServer();
    ASSERT_TRUE(server->start());
    bool fired = false;
    std::promise<void> later;
    TimerHandle kept;
    server->post([&] {
        auto cancelled = server->after(1ms, [&] { fired = true; });
        kept = server->after(20ms, [&] { later.set_value(); });
    });
    ASSERT_EQ(later.get_future().wait_for(kDeadline), std::future_status::ready);
    EXPECT_EQ(server->call([&] { return fired; }), false);
    EXPECT_TRUE(server->call([&] { kept.cancel(); }));
}

TEST(ServerTimer, HandlesMayOutliveTheServer) {
    TimerHandle handle;
    {
        const auto server = makeServer();
        handle = server->after(1h, [] {});
    }
    handle.cancel();
}

TEST(ServerTimer, CanBeSetAgainFromItself) {
    const auto server = makeServer();
    ASSERT_TRUE(server->start());
    TimerHandle handle;
    std::promise<void> done;
    int rounds = 0;
    std::function<void()> tick = [&] {
        if (++rounds == 5) {
            done.set_value();
            return;
        }
        handle = server->after(1ms, tick);
    };
    server->post([&] { handle = server->after(1ms, tick); });
    ASSERT_EQ(done.get_future().wait_for(kDeadline), std::future_status::ready);
    EXPECT_TRUE(server->call([&] { handle.cancel(); }));
}

/// Collects the sessions that ended, from the server's thread, and lets a test wait for them.
class Closed {
public:
    void add(const Session& session) {
        {
            const std::lock_guard lock(mutex_);
            sessions_.push_back(session);
        }
        changed_.notify_all();
    }
    std::vector<Session> waitFor(std::size_t count) {
        std::unique_lock lock(mutex_);
        changed_.wait_for(lock, kDeadline, [&] { return sessions_.size() >= count; });
        return sessions_;
    }

private:
    std::mutex mutex_;
    std::condition_variable changed_;
    std::vector<Session> sessions_;
};

TEST(ServerSession, TellsListenersWhichSessionWasClosed) {
    Closed closed;
    const auto server = makeServer();
    server->onSessionClosed([&](const Session& session) { closed.add(session); });
    ASSERT_TRUE(server->start());
    BareClient client;
    ASSERT_EQ(client.connect(server->endpointUrl()), status::kGood);
    client.disconnect();
    const auto sessions = closed.waitFor(1);
    ASSERT_EQ(sessions.size(), 1U);
    EXPECT_EQ(sessions[0].application_name, "bare client");
    EXPECT_THAT(sessions[0].application_uri, HasSubstr("urn:"));
    EXPECT_FALSE(sessions[0].id.isNull());
}

TEST(ServerSession, TellsListenersThatASessionTimedOut) {
    Closed closed;
    auto options = testOptions();
    options.limits.session_timeout = 500ms;
    const auto server = makeServer(options);
    server->onSessionClosed([&](const Session& session) { closed.add(session); });
    ASSERT_TRUE(server->start());
    BareClient client;
    ASSERT_EQ(client.connect(server->endpointUrl()), status::kGood);
    client.breakConnection();
    EXPECT_EQ(closed.waitFor(1).size(), 1U);
}

TEST(ServerSession, EndsAllSessionsWhenItStops) {
    Closed closed;
    const auto server = makeServer();
    server->onSessionClosed([&](const Session& session) { closed.add(session); });
    ASSERT_TRUE(server->start());
    BareClient first;
    BareClient second;
    ASSERT_EQ(first.connect(server->endpointUrl()), status::kGood);
    ASSERT_EQ(second.connect(server->endpointUrl()), status::kGood);
    ASSERT_GT(second.subscribe(50), 0);
    server->stop();
    EXPECT_EQ(closed.waitFor(2).size(), 2U);
}

}  // namespace
}  // namespace metier::opcua
