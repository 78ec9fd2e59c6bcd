// Our client, and the client of skills, against servers that mean no good.
#include "hostile_server.hpp"

#include <gmock/gmock.h>

#include <chrono>
#include <functional>

#include "answers.hpp"
#include "metier/client/control_handle.hpp"
#include "metier/client/kinematics_reader.hpp"
#include "metier/client/skill_finder.hpp"
#include "metier/client/skill_handle.hpp"
#include "metier/opcua/client.hpp"
#include "metier/opcua/discovery.hpp"

namespace metier::hostile {
namespace {

using namespace std::chrono_literals;
using opcua::Client;
using opcua::NodeId;
using opcua::Value;
using ::testing::HasSubstr;

constexpr auto kTimeout = 300ms;  ///< of one call
constexpr auto kLook = 30s;       ///< longest time for work of repeated requests
const NodeId kNode(1, 7'001U);

opcua::ClientOptions hasty() {
    opcua::ClientOptions options;
    options.connect_timeout = kTimeout;
    options.call_timeout = kTimeout;
    options.session_timeout = 6s;
    return options;
}

/// Fails the test unless the work ends in time; what comes of it is the server's to say.
void endsWithin(std::chrono::milliseconds longest, const char* what,
                const std::function<void()>& work) {
    const auto begin = std::chrono::steady_clock::now();
    work();
    const auto took = std::chrono::duration_cast<std::chrono::milliseconds>(
        std::chrono::steady_clock::now() - begin);
    EXPECT_LE(took, longest + kLongestAnswer) << what;
}

void readAndWrite(Client& client) {
    endsWithin(kTimeout, "read", [&] { static_cast<void>(client.read(kNode)); });
    endsWithin(kTimeout, "readMany", [&] {
        const auto values = client.readMany({{kNode}, {NodeId(1, 7'002U)}, {NodeId(0, 2258U)}});
        EXPECT_TRUE(!values || values->size() == 3U);
    });
    endsWithin(kTimeout, "write", [&] { static_cast<void>(client.write(kNode, Value::of(1.0))); });
    endsWithin(kTimeout, "writeMany", [&] {
        const auto statuses = client.writeMany({{kNode, Value::of(1.0)}, {kNode, Value::of(2.0)}});
        EXPECT_TRUE(!statuses || statuses->size() == 2U);
    });
    endsWithin(kTimeout, "call",
               [&] { static_cast<void>(client.call(kNode, kNode, {Value::of(true)})); });
}

void lookAround(Client& client) {
    endsWithin(kTimeout, "browse", [&] { static_cast<void>(client.browse({.node = kNode})); });
    endsWithin(kTimeout, "translate", [&] {
        static_cast<void>(client.translate(kNode, {{0, "CurrentState"}, {0, "Number"}}));
    });
    endsWithin(kTimeout, "namespaceArray", [&] { static_cast<void>(client.namespaceArray()); });
    endsWithin(kTimeout, "namespaceIndex",
               [&] { static_cast<void>(client.namespaceIndex("urn:any")); });
    endsWithin(kTimeout, "readUserExecutable",
               [&] { static_cast<void>(client.readUserExecutable(kNode)); });
}

void subscribe(Client& client) {
    opcua::Subscription events;
    opcua::Subscription data;
    endsWithin(kTimeout, "subscribeData", [&] {
        if (auto made = client.subscribeData(kNode, {}, [](const opcua::DataValue&) {})) {
            data = std::move(*made);
        }
    });
    endsWithin(kTimeout, "subscribeEvents", [&] {
        opcua::EventFilter filter;
        filter.fields = {{{0, "Message"}}, {{0, "Severity"}}};
        if (auto made = client.subscribeEvents(kNode, filter, [](const opcua::EventNotice&) {})) {
            events = std::move(*made);
        }
    });
}

void useSkill(Client& client, const client::SkillAddress& address) {
    static_cast<void>(client::typeChain(client, address));
    if (const auto nodes = client::findKinematics(client, address)) {
        static_cast<void>(client::readKinematics(client, *nodes));
        static_cast<void>(client::readJointPosition(client, *nodes));
    }
    auto skill = client::SkillHandle::open(client, address);
    if (!skill) {
        return;
    }
    const auto soon = [] { return std::chrono::steady_clock::now() + kTimeout; };
    static_cast<void>(skill->state());
    static_cast<void>(skill->result());
    static_cast<void>(skill->startWith({}));
    static_cast<void>(skill->check({}));
    static_cast<void>(skill->execution("1"));
    static_cast<void>(skill->run({}, soon()));
    static_cast<void>(skill->runWith({}, soon()));
    static_cast<void>(skill->awaitEnd(soon()));
}

void useSkills(Client& client) {
    std::vector<client::SkillAddress> skills;
    endsWithin(kLook, "findSkills", [&] {
        if (auto known = client::findSkills(client)) {
            skills = std::move(*known);
        }
    });
    skills.push_back({.name = "Move",
                      .display_name = "Move",
                      .node = kNode,
                      .type = NodeId(1, 7'002U),
                      .type_name = "MoveType",
                      .above = {{"Controllers", kNode}, {"Arm", kNode}, {"Skills", kNode}}});
    endsWithin(kLook, "a skill", [&] { useSkill(client, skills.front()); });
    endsWithin(kLook, "the last skill", [&] { useSkill(client, skills.back()); });
    endsWithin(kLook, "control",
               [&] { static_cast<void>(client::ControlHandle::acquire(client, kNode, {})); });
}

void tryEverything(const HostileServer::Character& character) {
    const HostileServer server(character);
    std::unique_ptr<Client> client;
    int connections = 0;
    for (int attempt = 0; attempt < 8; ++attempt) {
        endsWithin(2 * kTimeout, "connect", [&] {
            if (auto connected = Client::connect(server.url(), hasty())) {
                client = std::move(*connected);
            }
        });
        if (client) {
            ++connections;
            readAndWrite(*client);
            lookAround(*client);
            subscribe(*client);
            useSkills(*client);
        }
        endsWithin(1s, "the end of a client", [&] { client.reset(); });
    }
    endsWithin(kTimeout, "findServers",
               [&] { static_cast<void>(opcua::findServers(server.url(), kTimeout)); });
    endsWithin(kTimeout, "getEndpoints",
               [&] { static_cast<void>(opcua::getEndpoints(server.url(), kTimeout)); });
    EXPECT_GE(connections, character.from_the_start ? 0 : 4);
}

class HostileServers : public ::testing::TestWithParam<std::uint64_t> {};

TEST_P(HostileServers, WithWrongFieldsHarmNoClient) {
    tryEverything({.seed = GetParam(), .wrong_one_in = 25});
}
TEST_P(HostileServers, WithAnswersToSomethingElseHarmNoClient) {
    tryEverything({.seed = GetParam(), .wrong_one_in = 200, .odd_one_in = 12});
}
TEST_P(HostileServers, ThatAreSoFromTheStartHarmNoClient) {
    tryEverything(
        {.seed = GetParam(), .wrong_one_in = 60, .odd_one_in = 15, .from_the_start = true});
}
TEST_P(HostileServers, WithNodesInLoopsHarmNoClient) {
    tryEverything({.seed = GetParam()});
}

INSTANTIATE_TEST_SUITE_P(Seeds, HostileServers, ::testing::Values(1, 2, 3));

TEST(HostileServer, WithNodesWithoutEndIsGivenUp) {
    const HostileServer server({.landscape = Landscape::endless});
    auto options = hasty();
    options.call_timeout = 5s;
    const auto client = Client::connect(server.url(), options);
    ASSERT_TRUE(client) << client.error().message;
    endsWithin(kLook, "findSkills", [&] {
        const auto skills = client::findSkills(**client);
        ASSERT_FALSE(skills);
        EXPECT_EQ(skills.error().code, Errc::timeout);
        EXPECT_THAT(skills.error().message, HasSubstr("more than anybody would look at"));
    });
}

TEST(HostileServer, WithReferencesWithoutEndIsGivenUp) {
    const HostileServer server({.landscape = Landscape::plenty});
    auto options = hasty();
    options.call_timeout = 20s;
    const auto client = Client::connect(server.url(), options);
    ASSERT_TRUE(client) << client.error().message;
    endsWithin(10s, "browse", [&] {
        const auto references = (*client)->browse({.node = kNode});
        ASSERT_FALSE(references);
        EXPECT_EQ(references.error().status.name(), "BadEncodingLimitsExceeded");
    });
}

}  // namespace
}  // namespace metier::hostile
