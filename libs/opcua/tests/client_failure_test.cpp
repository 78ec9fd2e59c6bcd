#include <gmock/gmock.h>

#include <future>
#include <vector>

#include "client_bare_server.hpp"

namespace metier::opcua::testing {
namespace {

using namespace std::chrono_literals;
using std::chrono::steady_clock;
using ::testing::HasSubstr;

std::future<Answer<Value>> readInBackground(Client& client) {
    return std::async(std::launch::async,
                      [&client] { return client.read(kNumber, AttributeId::value, 20s); });
}

TEST(ClientFailure, EndsACallAtItsDeadlineWhenTheServerHangs) {
    BareServer server;
    const auto client = connected(server.url());
    server.pause();
    const auto begin = steady_clock::now();
    const auto value = client->read(kNumber, AttributeId::value, 100ms);
    const auto took = steady_clock::now() - begin;
    ASSERT_FALSE(value);
    EXPECT_EQ(value.error().status, status::kBadTimeout);
    EXPECT_EQ(value.error().code, Errc::timeout);
    EXPECT_THAT(value.error().message, HasSubstr("100 ms"));
    EXPECT_GE(took, 100ms);
    EXPECT_LT(took, 4s) << "the default is 5 s";
}

TEST(ClientFailure, EndsACallWithoutWaitingAtItsDeadline) {
    BareServer server;
    const auto client = connected(server.url());
    server.pause();
    std::promise<Answer<>> outcome;
    ASSERT_TRUE(client->writeAsync(
        {kNumber, Value::of(1.0), {}},
        [&](Answer<> written) { outcome.set_value(std::move(written)); }, 50ms));
    const auto written = outcome.get_future().get();
    ASSERT_FALSE(written);
    EXPECT_EQ(written.error().code, Errc::timeout);
}

TEST(ClientFailure, SurvivesAnswersThatComeTooLate) {
    BareServer server;
    const auto client = connected(server.url());
    server.pause();
    EXPECT_FALSE(client->read(kNumber, AttributeId::value, 20ms));
    server.resume();
    EXPECT_TRUE(client->read(kNumber));
    EXPECT_EQ(client->state(), Client::State::connected);
}

TEST(ClientFailure, RefusesMoreThanTheServerCanBeOwed) {
    BareServer server;
    const auto client = connected(server.url());
    server.pause();
    for (int i = 0; i < 2'000; ++i) {
        ASSERT_TRUE(client->callAsync({kHolder, kRefuse, {}}, [](const auto& /*result*/) {}));
    }
    const auto value = client->read(kNumber, AttributeId::value, 20s);
    ASSERT_FALSE(value);
    EXPECT_EQ(value.error().code, Errc::resource_unavailable);
}

/// Breaks the connection of a client with pending calls. \return how long it took to end them
std::chrono::nanoseconds timeToEndPendingCalls() {
    auto server = std::make_unique<BareServer>();
    const auto client = connected(server->url());
    std::promise<Failure> lost;
    client->onConnectionLost([&](const Failure& failure) { lost.set_value(failure); });
    server->pause();
    auto first = readInBackground(*client);
    auto second = readInBackground(*client);
    EXPECT_EQ(first.wait_for(50ms), std::future_status::timeout);
    const auto begin = steady_clock::now();
    server.reset();
    for (auto* pending : {&first, &second}) {
        const auto value = pending->get();
        if (!value) {  // the server may have answered when it woke up to stop
            EXPECT_EQ(value.error().code, Errc::connection_lost) << value.error().message;
        }
    }
    EXPECT_EQ(lost.get_future().get().code, Errc::connection_lost);
    const auto took = steady_clock::now() - begin;
    EXPECT_EQ(client->state(), Client::State::lost);
    return took;
}

TEST(ClientFailure, EndsPendingCallsWithinASecondWhenTheConnectionBreaks) {
    auto shortest = std::chrono::nanoseconds::max();
    for (int i = 0; i < 5 && shortest >= 1s; ++i) {  // the machine does not hold up all of them
        shortest = std::min(shortest, timeToEndPendingCalls());
    }
    EXPECT_LT(shortest, 1s);
}

TEST(ClientFailure, RefusesCallsAtOnceWhenTheConnectionIsLost) {
    auto server = std::make_unique<BareServer>();
    const auto client = connected(server->url());
    std::promise<void> lost;
    client->onConnectionLost([&](const Failure& /*failure*/) { lost.set_value(); });
    server.reset();
    ASSERT_EQ(lost.get_future().wait_for(30s), std::future_status::ready);
    EXPECT_EQ(client->read(kNumber).error().code, Errc::connection_lost);
    EXPECT_EQ(client
                  ->writeAsync({kNumber, Value::of(1.0), {}},
                               [](const Answer<>&) { FAIL() << "called although it was refused"; })
                  .error()
                  .code,
              Errc::connection_lost);
}

TEST(ClientFailure, TellsOfALossThatHappenedBefore) {
    auto server = std::make_unique<BareServer>();
    const auto client = connected(server->url());
    std::promise<void> first;
    client->onConnectionLost([&](const Failure& /*failure*/) { first.set_value(); });
    server.reset();
    ASSERT_EQ(first.get_future().wait_for(30s), std::future_status::ready);
    std::promise<void> second;
    client->onConnectionLost([&](const Failure& /*failure*/) { second.set_value(); });
    EXPECT_EQ(second.get_future().wait_for(30s), std::future_status::ready);
}

TEST(ClientFailure, GivesUpAServerThatHangsBeforeTheSessionTimesOut) {
    BareServer server;
    const auto client = connected(server.url(), {.session_timeout = 3s});
    std::promise<void> lost;
    client->onConnectionLost([&](const Failure& /*failure*/) { lost.set_value(); });
    server.pause();
    EXPECT_EQ(lost.get_future().wait_for(20s), std::future_status::ready);
    EXPECT_EQ(client->state(), Client::State::lost);
}

TEST(ClientFailure, DoesNotAskForNotificationsAgainOfAServerThatIsGivenUp) {
    BareServer server;
    const auto client = connected(server.url(), {.session_timeout = 3s});
    std::promise<StatusCode> ended;
    const auto subscription = client->subscribeData(kNumber, {}, [&](const DataValue& value) {
        if (value.status.isBad()) {
            ended.set_value(value.status);
        }
    });
    ASSERT_TRUE(subscription);
    server.pause();
    auto outcome = ended.get_future();
    ASSERT_EQ(outcome.wait_for(20s), std::future_status::ready);
    EXPECT_EQ(outcome.get(), status::kBadTimeout);
    EXPECT_EQ(client->state(), Client::State::lost);
}

/// Whether a session lives beyond its timeout, idle.
bool outlivesItsTimeout(const BareServer& server) {
    std::promise<void> lost;
    const auto client = connected(server.url(), {.session_timeout = 2s});
    client->onConnectionLost([&](const Failure& /*failure*/) { lost.set_value(); });
    return lost.get_future().wait_for(3'500ms) == std::future_status::timeout &&
           client->read(kNumber);
}

TEST(ClientFailure, KeepsAnIdleSessionAlive) {
    const BareServer server;
    bool lives = false;
    for (int i = 0; i < 5 && !lives; ++i) {  // the machine does not hold up all of them
        lives = outlivesItsTimeout(server);
    }
    EXPECT_TRUE(lives);
}

TEST(ClientFailure, EndsPendingCallsWhenItIsClosed) {
    BareServer server;
    auto client = connected(server.url());
    server.pause();
    auto pending = readInBackground(*client);
    ASSERT_EQ(pending.wait_for(50ms), std::future_status::timeout);
    EXPECT_TRUE(client->close());
    EXPECT_EQ(pending.get().error().code, Errc::connection_lost);
    EXPECT_EQ(client->state(), Client::State::closed);
    EXPECT_EQ(client->read(kNumber).error().code, Errc::connection_lost);
    EXPECT_TRUE(client->close());
}

TEST(ClientFailure, EndsPendingCallsWhenItIsDestroyed) {
    BareServer server;
    auto client = connected(server.url());
    server.pause();
    std::promise<Answer<CallResult>> outcome;
    ASSERT_TRUE(client->callAsync({kHolder, kRefuse, {}}, [&](Answer<CallResult> result) {
        outcome.set_value(std::move(result));
    }));
    const auto begin = steady_clock::now();
    client.reset();
    EXPECT_LT(steady_clock::now() - begin, 4s) << "the call may take 5 s";
    EXPECT_EQ(outcome.get_future().get().error().code, Errc::connection_lost);
}

TEST(ClientFailure, RefusesWaitingCallsFromItsCallbacks) {
    BareServer server;
    const auto client = connected(server.url());
    std::promise<std::pair<Errc, Errc>> refusals;
    ASSERT_TRUE(client->callAsync({kHolder, kRefuse, {}}, [&](const auto& /*result*/) {
        refusals.set_value({client->read(kNumber).error().code, client->close().error().code});
    }));
    const auto [read, close] = refusals.get_future().get();
    EXPECT_EQ(read, Errc::invalid_state);
    EXPECT_EQ(close, Errc::invalid_state);
}

TEST(ClientFailure, SendsFromItsCallbacksWithoutWaiting) {
    BareServer server;
    const auto client = connected(server.url());
    std::promise<bool> outcome;
    ASSERT_TRUE(client->writeAsync({kNumber, Value::of(1.0), {}}, [&](const Answer<>& /*done*/) {
        const auto sent = client->writeAsync(
            {kNumber, Value::of(2.0), {}},
            [&](const Answer<>& written) { outcome.set_value(written.has_value()); });
        EXPECT_TRUE(sent);
    }));
    EXPECT_TRUE(outcome.get_future().get());
}

TEST(ClientFailure, ServesEightThreadsAtOnce) {
    BareServer server;
    const auto client = connected(server.url());
    std::vector<std::future<int>> threads;
    for (int thread = 0; thread < 8; ++thread) {
        threads.push_back(std::async(std::launch::async, [&client, thread] {
            int right = 0;
            for (int i = 0; i < 100; ++i) {
                const auto sum =
                    client->call(kHolder, kAdd, {Value::of(double(thread)), Value::of(double(i))});
                right += sum && sum->outputs.front() == Value::of(double(thread + i)) ? 1 : 0;
            }
            return right;
        }));
    }
    for (auto& thread : threads) {
        EXPECT_EQ(thread.get(), 100);
    }
}

TEST(ClientFailure, MayBeClosedWhileThreadsCall) {
    BareServer server;
    const auto client = connected(server.url());
    std::vector<std::future<Errc>> threads;
    for (int thread = 0; thread < 4; ++thread) {
        threads.push_back(std::async(std::launch::async, [&client] {
            auto value = client->read(kNumber);
            while (value) {
                value = client->read(kNumber);
            }
            return value.error().code;
        }));
    }
    EXPECT_EQ(threads.front().wait_for(50ms), std::future_status::timeout);
    EXPECT_TRUE(client->close());
    for (auto& thread : threads) {
        EXPECT_EQ(thread.get(), Errc::connection_lost);
    }
}

}  // namespace
}  // namespace metier::opcua::testing
