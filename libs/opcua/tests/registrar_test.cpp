#include "metier/opcua/registrar.hpp"

#include <gmock/gmock.h>

#include <atomic>
#include <future>
#include <memory>

#include "metier/base/queue.hpp"
#include "metier/opcua/server.hpp"

namespace metier::opcua {
namespace {

using namespace std::chrono_literals;
using opcua::Answer;
using opcua::ServerRegistration;

SteadyTime soon() {
    return std::chrono::steady_clock::now() + 30s;
}

/// A discovery server whose answers are the test's.
class AnsweringServer {
public:
    struct Call {
        ServerRegistration::Presence presence;
        std::chrono::milliseconds timeout;
    };

    Registrar::Register registration() {
        return [this](const std::string& /*url*/, const ServerRegistration& server,
                      std::chrono::milliseconds timeout) {
            calls.tryPush({server.presence, timeout});
            return open ? Answer<>() : opcua::failed(opcua::status::kBadTimeout, "asking");
        };
    }

    std::atomic<bool> open = true;
    Queue<Call> calls{1'000};
};

RegistrarOptions options() {
    return {.discovery_url = "opc.tcp://lds:4840",
            .server = {.application_uri = "urn:a", .name = "a", .discovery_urls = {"opc.tcp://a"}},
            .period = 10ms,
            .pause = 5ms,
            .timeout = 200ms,
            .farewell = 70ms};
}

TEST(Registrar, RegistersAtOnceAndAgain) {
    AnsweringServer server;
    const Registrar registrar(options(), server.registration());
    for (int time = 0; time < 3; ++time) {
        const auto call = server.calls.popUntil(soon());
        ASSERT_TRUE(call);
        EXPECT_EQ(call->presence, ServerRegistration::Presence::online);
        EXPECT_EQ(call->timeout, 200ms);
    }
}

TEST(Registrar, TakesTheServerOutAtItsEnd) {
    AnsweringServer server;
    auto slow = options();
    slow.period = 1h;
    {
        const Registrar registrar(slow, server.registration());
        ASSERT_TRUE(server.calls.popUntil(soon()));
    }
    const auto last = server.calls.popUntil(soon());
    ASSERT_TRUE(last) << "the end does not wait for the next period";
    EXPECT_EQ(last->presence, ServerRegistration::Presence::offline);
    EXPECT_EQ(last->timeout, 70ms);
}

TEST(Registrar, AsksAgainUntilTheDiscoveryServerIsBack) {
    AnsweringServer server;
    server.open = false;
    {
        const Registrar registrar(options(), server.registration());
        ASSERT_TRUE(server.calls.popUntil(soon()));
        server.open = true;
        while (server.calls.popUntil(SteadyTime{})) {  // those that came before
        }
        ASSERT_TRUE(server.calls.popUntil(soon())) << "once it was back";
    }
    auto last = ServerRegistration::Presence::online;
    while (const auto call = server.calls.popUntil(SteadyTime{})) {
        last = call->presence;
    }
    EXPECT_EQ(last, ServerRegistration::Presence::offline) << "who takes itself out was in";
}

TEST(Registrar, DoesNotSayFarewellToAServerThatDidNotAnswer) {
    AnsweringServer server;
    server.open = false;
    {
        const Registrar registrar(options(), server.registration());
        ASSERT_TRUE(server.calls.popUntil(soon()));
    }
    while (const auto call = server.calls.popUntil(SteadyTime{})) {
        EXPECT_EQ(call->presence, ServerRegistration::Presence::online);
    }
}

TEST(Registrar, IsThereAgainAfterTheDiscoveryServerWasStartedAgain) {
    const auto start = [](std::uint16_t port) {
        opcua::ServerOptions lds;
        lds.port = port;
        lds.discovery.emplace();
        auto server = opcua::Server::create(std::move(lds)).value();
        EXPECT_TRUE(server->start());
        return server;
    };
    const auto knows = [](const opcua::Server& lds) {
        return opcua::findServers(lds.endpointUrl()).value().size() == 2;
    };
    auto lds = start(0);
    auto real = options();
    real.discovery_url = lds->endpointUrl();
    real.timeout = 10s;
    real.farewell = 10s;
    const auto port = lds->port();
    {
        const Registrar registrar(real);
        const auto deadline = soon();
        while (!knows(*lds)) {
            ASSERT_LT(std::chrono::steady_clock::now(), deadline);
        }
        lds.reset();
        lds = start(port);
        while (!knows(*lds)) {
            ASSERT_LT(std::chrono::steady_clock::now(), deadline);
        }
    }
    EXPECT_FALSE(knows(*lds)) << "it has said farewell";
}

}  // namespace
}  // namespace metier::opcua
