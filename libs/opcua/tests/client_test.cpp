#include "metier/opcua/client.hpp"

#include <gmock/gmock.h>

#include <atomic>

#include "client_bare_server.hpp"

namespace metier::opcua::testing {
namespace {

using namespace std::chrono_literals;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

class ClientTest : public ::testing::Test {
protected:
    BareServer server;
    std::unique_ptr<Client> client = connected(server.url());
};

TEST_F(ClientTest, ReadsAValue) {
    const auto value = client->read(kNumber);
    ASSERT_TRUE(value) << value.error().message;
    EXPECT_EQ(value->as<double>(), 1.5);
}

TEST_F(ClientTest, ReadsOtherAttributes) {
    const auto name = client->read(kNumber, AttributeId::browse_name);
    ASSERT_TRUE(name) << name.error().message;
    EXPECT_EQ(name->as<QualifiedName>(), (QualifiedName{1, "Number"}));
}

TEST_F(ClientTest, KeepsTheStatusCodeOfARefusedRead) {
    const auto value = client->read({1, "Nothing"});
    ASSERT_FALSE(value);
    EXPECT_EQ(value.error().status, status::kBadNodeIdUnknown);
    EXPECT_EQ(value.error().code, Errc::not_found);
    EXPECT_THAT(value.error().message, HasSubstr("ns=1;s=Nothing: BadNodeIdUnknown"));
}

TEST_F(ClientTest, TurnsItsFailuresIntoPlainErrors) {
    const Result<Value> value = client->read({1, "Nothing"});
    ASSERT_FALSE(value);
    EXPECT_EQ(value.error().code, Errc::not_found);
}

TEST_F(ClientTest, ReadsManyEachWithItsOwnStatus) {
    const auto values = client->readMany({{kNumber}, {{1, "Nothing"}}});
    ASSERT_TRUE(values) << values.error().message;
    ASSERT_EQ(values->size(), 2U);
    EXPECT_EQ(values->at(0).value, Value::of(1.5));
    EXPECT_EQ(values->at(1).status, status::kBadNodeIdUnknown);
}

TEST_F(ClientTest, RefusesAnEmptyListAsTheServerDoes) {
    const auto values = client->readMany({});
    ASSERT_FALSE(values);
    EXPECT_EQ(values.error().status, StatusCode(UA_STATUSCODE_BADNOTHINGTODO));
}

TEST_F(ClientTest, WritesAValueWithItsSourceTime) {
    const UtcTime then{1'700'000'000s};
    const auto written = client->write(kNumber, Value::of(2.5), then);
    ASSERT_TRUE(written) << written.error().message;
    const auto values = client->readMany({{kNumber}});
    ASSERT_TRUE(values);
    EXPECT_EQ(values->front().value, Value::of(2.5));
    EXPECT_EQ(values->front().source_time, then);
}

TEST_F(ClientTest, KeepsTheStatusCodeOfARefusedWrite) {
    const auto type = client->write(kNumber, Value::of("text"));
    ASSERT_FALSE(type);
    EXPECT_EQ(type.error().status, status::kBadTypeMismatch);
    const auto access = client->write(kReadOnly, Value::of(1.0));
    ASSERT_FALSE(access);
    EXPECT_EQ(access.error().code, Errc::access_denied);
}

TEST_F(ClientTest, WritesManyEachWithItsOwnStatus) {
    const auto written =
        client->writeMany({{kNumber, Value::of(3.5), {}}, {kNumber, Value::of(true), {}}});
    ASSERT_TRUE(written) << written.error().message;
    EXPECT_THAT(*written, ElementsAre(status::kGood, status::kBadTypeMismatch));
}

TEST_F(ClientTest, CallsAMethod) {
    const auto result = client->call(kHolder, kAdd, {Value::of(1.0), Value::of(2.0)});
    ASSERT_TRUE(result) << result.error().message;
    EXPECT_THAT(result->outputs, ElementsAre(Value::of(3.0)));
}

TEST_F(ClientTest, KeepsTheStatusCodeOfARefusedCall) {
    const auto result = client->call(kHolder, kRefuse);
    ASSERT_FALSE(result);
    EXPECT_EQ(result.error().status, status::kBadInvalidState);
    EXPECT_EQ(result.error().code, Errc::invalid_state);
}

TEST_F(ClientTest, SaysWhichArgumentWasRefused) {
    const auto result = client->call(kHolder, kAdd, {Value::of(1.0), Value::of("two")});
    ASSERT_FALSE(result);
    EXPECT_THAT(result.error().input_results, ElementsAre(status::kGood, status::kBadTypeMismatch));
    EXPECT_THAT(result.error().message, HasSubstr("argument 2: BadTypeMismatch"));
}

TEST_F(ClientTest, BrowsesOverContinuationPoints) {
    const auto references = client->browse({.node = kMany, .references_at_once = 7});
    ASSERT_TRUE(references) << references.error().message;
    ASSERT_EQ(references->size(), 50U);
    EXPECT_EQ(references->front().type, ids::kHasComponent);
    EXPECT_EQ(references->front().type_definition, ids::kBaseDataVariableType);
}

TEST_F(ClientTest, BrowsesWhatItIsAskedFor) {
    const auto methods = client->browse({.node = kHolder, .node_classes = {NodeClass::method}});
    ASSERT_TRUE(methods) << methods.error().message;
    EXPECT_EQ(methods->size(), 3U);
    const auto parents =
        client->browse({.node = kHolder, .direction = BrowseQuery::Direction::inverse});
    ASSERT_TRUE(parents) << parents.error().message;
    ASSERT_EQ(parents->size(), 1U);
    EXPECT_EQ(parents->front().target, ids::kObjectsFolder);
}

TEST_F(ClientTest, KeepsTheStatusCodeOfARefusedBrowse) {
    const auto references = client->browse({.node = {1, "Nothing"}});
    ASSERT_FALSE(references);
    EXPECT_EQ(references.error().status, status::kBadNodeIdUnknown);
}

TEST_F(ClientTest, FollowsAPath) {
    const auto target = client->translate(ids::kObjectsFolder, {{1, "Holder"}, {1, "Add"}});
    ASSERT_TRUE(target) << target.error().message;
    EXPECT_EQ(*target, kAdd);
}

TEST_F(ClientTest, SaysWhichPathLeadsNowhere) {
    const auto targets = client->translateMany(
        {{ids::kObjectsFolder, {{1, "Holder"}}}, {ids::kObjectsFolder, {{1, "Nothing"}}}});
    ASSERT_TRUE(targets) << targets.error().message;
    ASSERT_EQ(targets->size(), 2U);
    EXPECT_EQ(targets->at(0), kHolder);
    ASSERT_FALSE(targets->at(1));
    EXPECT_EQ(targets->at(1).error().status, status::kBadNoMatch);
    EXPECT_THAT(targets->at(1).error().message, HasSubstr("i=85/1:Nothing"));
}

TEST_F(ClientTest, FindsNamespaces) {
    const auto uris = client->namespaceArray();
    ASSERT_TRUE(uris) << uris.error().message;
    EXPECT_EQ(uris->front(), "http://opcfoundation.org/UA/");
    EXPECT_EQ(client->namespaceIndex("http://opcfoundation.org/UA/"), std::uint16_t{0});
    const auto unknown = client->namespaceIndex("urn:nobody");
    ASSERT_FALSE(unknown);
    EXPECT_EQ(unknown.error().code, Errc::not_found);
}

TEST_F(ClientTest, TellsWhetherAMethodMayBeCalled) {
    const auto executable = client->readUserExecutable(kAdd);
    ASSERT_TRUE(executable) << executable.error().message;
    EXPECT_TRUE(*executable);
}

TEST_F(ClientTest, WritesAndCallsWithoutWaitingInOrder) {
    Condition heard;
    std::vector<std::string> outcomes;
    const auto hear = [&](std::string text) {
        heard.notify([&] { outcomes.push_back(std::move(text)); });
    };
    for (const auto& value : {Value::of(1.0), Value::of("wrong"), Value::of(3.0)}) {
        ASSERT_TRUE(client->writeAsync({kNumber, value, {}}, [&](const Answer<>& written) {
            hear(written ? "written" : written.error().status.name());
        }));
    }
    ASSERT_TRUE(client->callAsync({kHolder, kRefuse, {}}, [&](const Answer<CallResult>& result) {
        hear(result ? "called" : result.error().status.name());
    }));
    ASSERT_TRUE(heard.wait([&] { return outcomes.size() == 4; }));
    EXPECT_THAT(outcomes, ElementsAre("written", "BadTypeMismatch", "written", "BadInvalidState"));
    EXPECT_EQ(client->read(kNumber)->as<double>(), 3.0);
}

TEST_F(ClientTest, RunsWorkAfterADelay) {
    Condition heard;
    std::vector<std::string> outcomes;
    const auto note = [&](const std::string& text) {
        return [&heard, &outcomes, text] { heard.notify([&] { outcomes.push_back(text); }); };
    };
    const auto begin = std::chrono::steady_clock::now();
    ASSERT_TRUE(client->runAfter(300ms, note("later")));
    ASSERT_TRUE(client->runAfter(-1s, note("now")));
    ASSERT_TRUE(heard.wait([&] { return outcomes.size() == 2; }));
    EXPECT_THAT(outcomes, ElementsAre("now", "later"));
    EXPECT_GE(std::chrono::steady_clock::now() - begin, 300ms);
}

TEST_F(ClientTest, RunsDelayedWorkAtOnceWhenItIsClosed) {
    std::atomic<int> ran = 0;
    ASSERT_TRUE(client->runAfter(1h, [&] { ++ran; }));
    ASSERT_TRUE(client->close());
    EXPECT_EQ(ran, 1);
    const auto refused = client->runAfter(0ms, [&] { ++ran; });
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, Errc::connection_lost);
    EXPECT_EQ(ran, 1);
}

TEST(ClientConnect, SaysThatNobodyIsThere) {
    const auto client = Client::connect("opc.tcp://127.0.0.1:1");
    ASSERT_FALSE(client);
    EXPECT_EQ(client.error().code, Errc::connection_lost);
    EXPECT_THAT(client.error().message, HasSubstr("opc.tcp://127.0.0.1:1"));
}

TEST(ClientConnect, RefusesWhatIsNoUrlAndTimesThatAreNone) {
    EXPECT_EQ(Client::connect("http://127.0.0.1").error().code, Errc::invalid_argument);
    EXPECT_EQ(Client::connect("opc.tcp://127.0.0.1", {.call_timeout = 0ms}).error().code,
              Errc::invalid_argument);
}

TEST(ClientConnect, EndsAtItsDeadlineWhenNobodyAnswers) {
    const MuteListener listener;
    const auto begin = std::chrono::steady_clock::now();
    const auto client = Client::connect(listener.url(), {.connect_timeout = 100ms});
    ASSERT_FALSE(client);
    EXPECT_EQ(client.error().status, status::kBadTimeout);
    EXPECT_LT(std::chrono::steady_clock::now() - begin, 4s) << "its default is 5 s";
}

TEST(ClientConnect, IsRefusedWithAnUnknownUser) {
    const BareServer server;
    const auto client =
        Client::connect(server.url(), {.user = UserName{.name = "user1", .password = "wrong"}});
    ASSERT_FALSE(client);
    EXPECT_EQ(client.error().code, Errc::access_denied) << client.error().message;
}

TEST(ClientConnect, LogsInByUserName) {
    const BareServer server;
    const auto client =
        Client::connect(server.url(), {.user = UserName{.name = "user1", .password = "password"}});
    ASSERT_TRUE(client) << client.error().message;
    EXPECT_TRUE((*client)->read(kNumber));
}

}  // namespace
}  // namespace metier::opcua::testing
