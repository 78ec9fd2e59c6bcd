#include <gmock/gmock.h>

#include <future>
#include <optional>

#include "client_bare_server.hpp"
#include "metier/base/queue.hpp"
#include "tcp_relay.hpp"

namespace metier::opcua::testing {
namespace {

using namespace std::chrono_literals;
using std::chrono::steady_clock;
using ::testing::HasSubstr;
using Change = ConnectionChange::Kind;
using Delivery = Failure::Delivery;
using Kind = EventNotice::Kind;
using metier::testing::TcpRelay;

const std::vector<QualifiedName> kMessage{{0, "Message"}};

SteadyTime soon() {
    return steady_clock::now() + 30s;
}

/// A server behind a network that can be cut, and a client that comes back.
class ReconnectTest : public ::testing::Test {
protected:
    ReconnectTest() {
        client->onConnectionChange(
            [this](const ConnectionChange& change) { changes.tryPush(change); });
    }
    ~ReconnectTest() override { client.reset(); }

    static ClientOptions options() {
        return {.session_timeout = 10s,
                .call_timeout = 5s,
                .publishing_interval = 20ms,
                .reconnect = ReconnectOptions{.shortest_pause = 20ms, .longest_pause = 200ms}};
    }
    void stop() {
        port = server->port();
        server.reset();
    }
    void startAgain(BareServerOptions with = {}) {
        with.port = port;
        server = std::make_unique<BareServer>(with);
    }
    void restart() {
        stop();
        startAgain();
    }
    ConnectionChange next() { return changes.popUntil(soon()).value(); }
    ConnectionChange nextIs(Change kind) {
        auto change = next();
        EXPECT_EQ(change.kind, kind) << change.why.message;
        return change;
    }
    Answer<Subscription> subscribeEvents() {
        return client->subscribeEvents(kHolder, {.fields = {kMessage}},
                                       [this](const auto& notice) { notices.tryPush(notice); });
    }
    Kind nextKind() { return notices.popUntil(soon()).value().kind; }

    std::unique_ptr<BareServer> server = std::make_unique<BareServer>();
    std::uint16_t port = 0;
    TcpRelay relay{server->port()};
    Queue<ConnectionChange> changes{100};
    Queue<EventNotice> notices{100};
    std::unique_ptr<Client> client = connected(relay.url(), options());
};

TEST_F(ReconnectTest, ComesBackToAServerThatWasStartedAgain) {
    stop();
    const auto lost = nextIs(Change::lost);
    EXPECT_EQ(lost.why.code, Errc::connection_lost);
    EXPECT_EQ(client->state(), Client::State::reconnecting);
    startAgain();
    const auto back = nextIs(Change::back);
    EXPECT_TRUE(back.server_restarted);
    EXPECT_FALSE(back.same_session);
    EXPECT_GE(back.time, lost.time);
    EXPECT_EQ(client->boot(), 2U);
    EXPECT_EQ(client->state(), Client::State::connected);
    EXPECT_TRUE(client->read(kNumber));
}

TEST_F(ReconnectTest, ComesBackAgainAndAgain) {
    for (std::uint64_t i = 2; i < 6; ++i) {
        restart();
        nextIs(Change::lost);
        EXPECT_TRUE(nextIs(Change::back).server_restarted);
        EXPECT_EQ(client->boot(), i);
        relay.cut();
        nextIs(Change::lost);
        relay.pass();
        EXPECT_FALSE(nextIs(Change::back).server_restarted);
        EXPECT_TRUE(client->read(kNumber));
    }
}

TEST_F(ReconnectTest, TakesItsSessionUpAgainAfterACut) {
    relay.cut();
    nextIs(Change::lost);
    relay.pass();
    const auto back = nextIs(Change::back);
    EXPECT_TRUE(back.same_session);
    EXPECT_FALSE(back.server_restarted);
    EXPECT_EQ(client->boot(), 1U);
    EXPECT_TRUE(client->read(kNumber));
}

TEST_F(ReconnectTest, NoticesThatTheNetworkSwallowsEverything) {
    relay.stall();
    const auto lost = nextIs(Change::lost);
    EXPECT_EQ(lost.why.status, status::kBadTimeout);
    relay.pass();
    const auto back = nextIs(Change::back);
    EXPECT_TRUE(back.same_session);
    EXPECT_TRUE(client->read(kNumber));
}

TEST_F(ReconnectTest, IsGivenTheEventsThatHappenedMeanwhileIfItsSessionWasKept) {
    const auto direct = connected(server->url());
    const auto subscription = subscribeEvents();
    ASSERT_TRUE(subscription) << subscription.error().message;
    relay.cut();
    nextIs(Change::lost);
    EXPECT_EQ(nextKind(), Kind::interrupted);
    ASSERT_TRUE(direct->call(kHolder, kRaise, {Value::of(std::uint32_t{3})}));
    relay.pass();
    ASSERT_TRUE(nextIs(Change::back).same_session);
    EXPECT_EQ(nextKind(), Kind::resumed);
    for (const std::string expected : {"1", "2", "3"}) {
        const auto notice = notices.popUntil(soon()).value();
        ASSERT_EQ(notice.kind, Kind::event);
        EXPECT_EQ(notice.fields.front().as<LocalizedText>()->text, expected);
    }
}

TEST_F(ReconnectTest, SubscribesAgainAtAServerThatWasStartedAgain) {
    Queue<DataValue> values{100};
    const auto events = subscribeEvents();
    const auto data = client->subscribeData(kNumber, {.sampling_interval = 0ms},
                                            [&](const DataValue& value) { values.tryPush(value); });
    ASSERT_TRUE(events && data);
    EXPECT_EQ(values.popUntil(soon())->value, Value::of(1.5));
    restart();
    EXPECT_TRUE(values.popUntil(soon())->status.isBad());
    EXPECT_EQ(values.popUntil(soon())->value, Value::of(1.5));
    EXPECT_EQ(nextKind(), Kind::interrupted);
    EXPECT_EQ(nextKind(), Kind::overflow);
    EXPECT_EQ(nextKind(), Kind::resumed);
    ASSERT_TRUE(client->awaitConnected(soon()));
    ASSERT_TRUE(client->call(kHolder, kRaise, {Value::of(std::uint32_t{1})}));
    EXPECT_EQ(nextKind(), Kind::event);
}

TEST_F(ReconnectTest, SubscribesInTheNamespaceWhereverItIsNow) {
    const auto before = client->namespaceIndex(kMovingUri).value();
    Queue<DataValue> values{100};
    const auto data = client->subscribeData({before, kMoving}, {.sampling_interval = 0ms},
                                            [&](const DataValue& value) { values.tryPush(value); });
    ASSERT_TRUE(data);
    EXPECT_EQ(values.popUntil(soon())->value, Value::of(1.5));
    stop();
    startAgain({.namespaces_before = 3});
    EXPECT_TRUE(values.popUntil(soon())->status.isBad());
    EXPECT_EQ(values.popUntil(soon())->value, Value::of(1.5));
    ASSERT_TRUE(client->awaitConnected(soon()));
    EXPECT_EQ(client->namespaceIndex(kMovingUri).value(), before + 3);
}

TEST_F(ReconnectTest, SendsNoCommandToANodeOfAnotherRunOfTheServer) {
    const auto boot = client->boot();
    restart();
    nextIs(Change::lost);
    nextIs(Change::back);
    const std::vector<Value> inputs{Value::of(1.0), Value::of(2.0)};
    const auto stale =
        client->call({.object = kHolder, .method = kAdd, .inputs = inputs, .boot = boot});
    ASSERT_FALSE(stale);
    EXPECT_EQ(stale.error().delivery, Delivery::not_sent);
    EXPECT_THAT(stale.error().message, HasSubstr("started again"));
    const auto written =
        client->writeMany({{.node = kNumber, .value = Value::of(2.0), .boot = boot}});
    EXPECT_EQ(written.error().delivery, Delivery::not_sent);
    EXPECT_TRUE(client->call(
        {.object = kHolder, .method = kAdd, .inputs = inputs, .boot = client->boot()}));
}

TEST_F(ReconnectTest, SendsNothingLaterThatWasAskedForWithoutAConnection) {
    relay.cut();
    nextIs(Change::lost);
    const auto begin = steady_clock::now();
    const auto written = client->write(kNumber, Value::of(7.0));
    EXPECT_LT(steady_clock::now() - begin, 4s) << "it waited for its deadline";
    ASSERT_FALSE(written);
    EXPECT_EQ(written.error().code, Errc::connection_lost);
    EXPECT_EQ(written.error().delivery, Delivery::not_sent);
    EXPECT_FALSE(client->writeAsync({kNumber, Value::of(8.0)}, [](const Answer<>&) {
        ADD_FAILURE() << "called although it was refused";
    }));
    relay.pass();
    nextIs(Change::back);
    EXPECT_EQ(client->read(kNumber).value(), Value::of(1.5));
}

TEST_F(ReconnectTest, TellsThatALostAnswerLeavesItUnknown) {
    struct Case {
        TcpRelay::Moment moment;
        double value;
        double afterwards;
    };
    for (const auto& [moment, value, afterwards] :
         {Case{TcpRelay::Moment::before, 7.0, 1.5}, Case{TcpRelay::Moment::after, 8.0, 8.0}}) {
        relay.cutAt("Number", moment);
        const auto written = client->write(kNumber, Value::of(value));
        ASSERT_FALSE(written);
        EXPECT_EQ(written.error().code, Errc::connection_lost);
        EXPECT_EQ(written.error().delivery, Delivery::unknown);
        EXPECT_THAT(written.error().message, HasSubstr("unknown whether it was carried out"));
        nextIs(Change::lost);
        relay.pass();
        nextIs(Change::back);
        EXPECT_EQ(client->read(kNumber).value(), Value::of(afterwards));
    }
}

TEST_F(ReconnectTest, TellsThatATimeoutLeavesItUnknown) {
    server->pause();
    // Long enough for the client's thread to send it in time.
    const auto result = client->call({kHolder, kRefuse, {}}, 1s);
    server->resume();
    ASSERT_FALSE(result);
    EXPECT_EQ(result.error().code, Errc::timeout);
    EXPECT_EQ(result.error().delivery, Delivery::unknown);
    EXPECT_EQ(client->call(kHolder, kRefuse).error().delivery, Delivery::answered);
}

TEST_F(ReconnectTest, WaitsForTheConnectionNoLongerThanItMay) {
    stop();
    nextIs(Change::lost);
    const auto late = client->awaitConnected(steady_clock::now() + 50ms);
    ASSERT_FALSE(late);
    EXPECT_EQ(late.error().code, Errc::timeout);
    EXPECT_EQ(late.error().delivery, Delivery::not_sent);
    auto waiting =
        std::async(std::launch::async, [this] { return client->awaitConnected(soon()); });
    startAgain();
    EXPECT_TRUE(waiting.get());
    EXPECT_TRUE(client->awaitConnected(steady_clock::now())) << "is connected";
}

TEST_F(ReconnectTest, EndsAWaitForTheConnectionWhenItIsClosed) {
    stop();
    nextIs(Change::lost);
    auto waiting =
        std::async(std::launch::async, [this] { return client->awaitConnected(soon()); });
    const auto begin = steady_clock::now();
    EXPECT_TRUE(client->close());
    EXPECT_EQ(waiting.get().error().code, Errc::connection_lost);
    EXPECT_LT(steady_clock::now() - begin, 10s);
    EXPECT_EQ(client->state(), Client::State::closed);
}

TEST_F(ReconnectTest, EndsWhileItTriesToConnect) {
    relay.stall();
    nextIs(Change::lost);
    const auto begin = steady_clock::now();
    client.reset();
    EXPECT_LT(steady_clock::now() - begin, 10s);
}

TEST_F(ReconnectTest, RefusesToWaitInACallback) {
    std::promise<Errc> refusal;
    ASSERT_TRUE(client->callAsync({kHolder, kRefuse, {}}, [&](const auto& /*result*/) {
        refusal.set_value(client->awaitConnected(soon()).error().code);
    }));
    EXPECT_EQ(refusal.get_future().get(), Errc::invalid_state);
}

TEST_F(ReconnectTest, EndsASubscriptionOfANodeThatTheRestartedServerLacks) {
    Queue<DataValue> values{10};
    const auto gone =
        client->subscribeData({1, "0"}, {}, [&](const DataValue& value) { values.tryPush(value); });
    const auto stays = subscribeEvents();
    ASSERT_TRUE(gone) << gone.error().message;
    ASSERT_TRUE(stays);
    ASSERT_TRUE(values.popUntil(soon()));
    stop();
    startAgain({.many = 0});
    EXPECT_TRUE(values.popUntil(soon())->status.isBad()) << "interrupted";
    EXPECT_EQ(values.popUntil(soon())->status, status::kBadNodeIdUnknown) << "ended";
    EXPECT_EQ(nextKind(), Kind::interrupted);
    EXPECT_EQ(nextKind(), Kind::overflow);
    EXPECT_EQ(nextKind(), Kind::resumed);
}

TEST(Reconnect, IsGivenUpAfterTheTimeThatItMayTake) {
    auto server = std::make_unique<BareServer>();
    const auto client =
        connected(server->url(),
                  {.reconnect = ReconnectOptions{
                       .shortest_pause = 20ms, .longest_pause = 50ms, .give_up_after = 200ms}});
    std::promise<ConnectionChange> given_up;
    client->onConnectionChange([&](const ConnectionChange& change) {
        if (change.kind == Change::given_up) {
            given_up.set_value(change);
        }
    });
    Queue<EventNotice> notices{10};
    const auto events = client->subscribeEvents(kHolder, {.fields = {kMessage}},
                                                [&](const auto& n) { notices.tryPush(n); });
    ASSERT_TRUE(events);
    server.reset();
    auto told = given_up.get_future();
    ASSERT_EQ(told.wait_for(30s), std::future_status::ready);
    EXPECT_EQ(client->state(), Client::State::lost);
    EXPECT_EQ(client->awaitConnected(soon()).error().code, Errc::connection_lost);
    EXPECT_THAT(client->whyLost()->message, HasSubstr("connecting to"));
    EXPECT_EQ(notices.popUntil(soon())->kind, Kind::interrupted);
    EXPECT_EQ(notices.popUntil(soon())->kind, Kind::ended);
    EXPECT_EQ(client->read(kNumber).error().code, Errc::connection_lost);
}

TEST(Reconnect, IsGivenUpIfTheServerDoesNotLetItsUserInAnyMore) {
    auto server = std::make_unique<BareServer>();
    const auto port = server->port();
    const auto client =
        connected(server->url(), {.user = UserName{.name = "user1", .password = "password"},
                                  .reconnect = ReconnectOptions{.shortest_pause = 20ms}});
    std::promise<ConnectionChange> given_up;
    client->onConnectionChange([&](const ConnectionChange& change) {
        if (change.kind == Change::given_up) {
            given_up.set_value(change);
        }
    });
    server.reset();
    server = std::make_unique<BareServer>(BareServerOptions{.port = port, .password = "changed"});
    auto told = given_up.get_future();
    ASSERT_EQ(told.wait_for(30s), std::future_status::ready);
    EXPECT_EQ(told.get().why.code, Errc::access_denied);
}

TEST(Reconnect, RefusesOptionsWithoutAMeaning) {
    for (const auto& wrong : {ReconnectOptions{.shortest_pause = 0ms},
                              ReconnectOptions{.shortest_pause = 20ms, .longest_pause = 10ms},
                              ReconnectOptions{.jitter = 1.5}, ReconnectOptions{.jitter = -0.1}}) {
        const auto client = Client::connect("opc.tcp://127.0.0.1:1", {.reconnect = wrong});
        ASSERT_FALSE(client);
        EXPECT_EQ(client.error().code, Errc::invalid_argument);
    }
}

}  // namespace
}  // namespace metier::opcua::testing
