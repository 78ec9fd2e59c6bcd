#include <gmock/gmock.h>

#include <future>
#include <optional>
#include <vector>

#include "client_bare_server.hpp"

namespace metier::opcua::testing {
namespace {

using namespace std::chrono_literals;
using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::Field;
using ::testing::HasSubstr;
using Kind = EventNotice::Kind;

const std::vector<QualifiedName> kMessage{{0, "Message"}};
const std::vector<QualifiedName> kEventType{{0, "EventType"}};
const std::vector<QualifiedName> kOfAnotherType{{0, "MethodId"}};
const NodeId kTransitionEventType{0, 2311U};  // the events raised here are of a subtype
const NodeId kSystemEventType{0, 2130U};

/// Notifications that a subscriber got, in order.
template <typename Notice>
class Heard {
public:
    void add(const Notice& notice) {
        changed_.notify([&] { notices_.push_back(notice); });
    }
    auto callback() {
        return [this](const Notice& notice) { add(notice); };
    }
    bool waitFor(std::size_t count) {
        return changed_.wait([&] { return notices_.size() >= count; });
    }
    /// Only when nothing is added any more.
    const std::vector<Notice>& all() const { return notices_; }

private:
    Condition changed_;
    std::vector<Notice> notices_;
};

std::vector<std::string> messagesOf(const std::vector<EventNotice>& notices) {
    std::vector<std::string> messages;
    for (const auto& notice : notices) {
        const auto text = notice.fields.front().as<LocalizedText>();
        messages.push_back(text ? text->text : text.error().message);
    }
    return messages;
}

class ClientSubscriptionTest : public ::testing::Test {
protected:
    void raiseEvents(std::uint32_t count) {
        const auto raised = client->call(kHolder, kRaise, {Value::of(count)});
        ASSERT_TRUE(raised) << raised.error().message;
    }

    BareServer server;
    Heard<EventNotice> events;
    Heard<DataValue> values;
    std::unique_ptr<Client> client = connected(server.url(), {.publishing_interval = 20ms});
};

TEST_F(ClientSubscriptionTest, DeliversTheFieldsOfEventsInOrder) {
    const auto subscription = client->subscribeEvents(
        kHolder, {.fields = {kMessage, kEventType, kOfAnotherType}}, events.callback());
    ASSERT_TRUE(subscription) << subscription.error().message;
    raiseEvents(3);
    ASSERT_TRUE(events.waitFor(3));
    EXPECT_THAT(messagesOf(events.all()), ElementsAre("1", "2", "3"));
    EXPECT_THAT(events.all(), Each(Field(&EventNotice::kind, Kind::event)));
    ASSERT_EQ(events.all().front().fields.size(), 3U);
    EXPECT_EQ(events.all().front().fields[1], Value::of(ids::kProgramTransitionEventType));
    EXPECT_TRUE(events.all().front().fields[2].isEmpty());
}

TEST_F(ClientSubscriptionTest, DeliversManyEventsInOrder) {
    const auto subscription =
        client->subscribeEvents(kHolder, {.fields = {kMessage}}, events.callback());
    ASSERT_TRUE(subscription) << subscription.error().message;
    for (int i = 0; i < 50; ++i) {
        raiseEvents(1);
    }
    ASSERT_TRUE(events.waitFor(50));
    EXPECT_THAT(messagesOf(events.all()), Each("1"));
}

TEST_F(ClientSubscriptionTest, DeliversOnlyEventsOfATypeAndItsSubtypes) {
    Heard<EventNotice> others;
    const auto other = client->subscribeEvents(
        kHolder, {.fields = {kMessage}, .of_type = kSystemEventType}, others.callback());
    const auto subtype = client->subscribeEvents(
        kHolder, {.fields = {kMessage}, .of_type = kTransitionEventType}, events.callback());
    ASSERT_TRUE(other) << other.error().message;
    ASSERT_TRUE(subtype) << subtype.error().message;
    raiseEvents(3);
    ASSERT_TRUE(events.waitFor(3));
    EXPECT_TRUE(others.all().empty());
}

TEST_F(ClientSubscriptionTest, TellsThatEventsWereLost) {
    server.limitQueues(3);
    const auto subscription =
        client->subscribeEvents(kHolder, {.fields = {kMessage, kEventType}}, events.callback());
    ASSERT_TRUE(subscription) << subscription.error().message;
    raiseEvents(10);
    ASSERT_TRUE(events.waitFor(2));
    raiseEvents(1);
    const auto& heard = events.all();
    ASSERT_TRUE(events.waitFor(5));
    const auto overflows = std::count_if(heard.begin(), heard.end(), [](const auto& notice) {
        return notice.kind == Kind::overflow && notice.fields.empty();
    });
    EXPECT_EQ(overflows, 1);
}

TEST_F(ClientSubscriptionTest, RefusesANotifierThatIsNone) {
    const auto subscription =
        client->subscribeEvents({1, "Nothing"}, {.fields = {kMessage}}, events.callback());
    ASSERT_FALSE(subscription);
    EXPECT_EQ(subscription.error().status, status::kBadNodeIdUnknown);
}

TEST_F(ClientSubscriptionTest, NamesTheFieldThatTheServerDoesNotKnow) {
    const auto subscription = client->subscribeEvents(
        kHolder, {.fields = {kMessage, {{0, "Message"}, {1, "Nothing"}}}}, events.callback());
    ASSERT_FALSE(subscription);
    EXPECT_EQ(subscription.error().status, status::kBadNodeIdUnknown);
    EXPECT_THAT(subscription.error().message, HasSubstr("field 0:Message/1:Nothing"));
}

TEST_F(ClientSubscriptionTest, RefusesEventsWithoutFields) {
    const auto subscription = client->subscribeEvents(kHolder, {}, events.callback());
    ASSERT_FALSE(subscription);
    EXPECT_EQ(subscription.error().code, Errc::invalid_argument);
}

TEST_F(ClientSubscriptionTest, DeliversAValueNowAndWhenItChanges) {
    const auto subscription =
        client->subscribeData(kNumber, {.sampling_interval = 0ms}, values.callback());
    ASSERT_TRUE(subscription) << subscription.error().message;
    ASSERT_TRUE(values.waitFor(1));
    ASSERT_TRUE(client->write(kNumber, Value::of(2.5)));
    ASSERT_TRUE(values.waitFor(2));
    EXPECT_EQ(values.all()[0].value, Value::of(1.5));
    EXPECT_EQ(values.all()[1].value, Value::of(2.5));
}

TEST_F(ClientSubscriptionTest, IsSilentOnceItHasEnded) {
    auto subscription = client->subscribeEvents(kHolder, {.fields = {kMessage}}, events.callback());
    Heard<EventNotice> others;
    const auto other = client->subscribeEvents(kHolder, {.fields = {kMessage}}, others.callback());
    ASSERT_TRUE(subscription && other);
    *subscription = Subscription();
    raiseEvents(1);
    ASSERT_TRUE(others.waitFor(1));
    EXPECT_TRUE(events.all().empty());
}

TEST_F(ClientSubscriptionTest, MayEndInItsOwnCallback) {
    std::optional<Subscription> mine;
    std::promise<void> ended;
    Heard<EventNotice> others;
    auto subscription =
        client->subscribeEvents(kHolder, {.fields = {kMessage}}, [&](const EventNotice& notice) {
            events.add(notice);
            mine.reset();
            ended.set_value();
        });
    const auto other = client->subscribeEvents(kHolder, {.fields = {kMessage}}, others.callback());
    ASSERT_TRUE(subscription && other);
    mine = std::move(*subscription);
    raiseEvents(2);
    ASSERT_TRUE(others.waitFor(2));
    ASSERT_EQ(ended.get_future().wait_for(30s), std::future_status::ready);
    EXPECT_EQ(events.all().size(), 1U);
}

TEST_F(ClientSubscriptionTest, SaysThatItEndedWhenTheConnectionIsLost) {
    auto short_lived = std::make_unique<BareServer>();
    const auto other = connected(short_lived->url());
    const auto on_events =
        other->subscribeEvents(kHolder, {.fields = {kMessage}}, events.callback());
    const auto on_data = other->subscribeData(kNumber, {}, values.callback());
    ASSERT_TRUE(on_events && on_data);
    ASSERT_TRUE(values.waitFor(1));
    short_lived.reset();
    ASSERT_TRUE(events.waitFor(1));
    ASSERT_TRUE(values.waitFor(2));
    EXPECT_TRUE(other->close());
    EXPECT_THAT(events.all(), ElementsAre(Field(&EventNotice::kind, Kind::ended)));
    EXPECT_TRUE(values.all()[1].status.isBad());
    EXPECT_TRUE(values.all()[1].value.isEmpty());
}

TEST_F(ClientSubscriptionTest, MayOutliveItsClient) {
    auto subscription = client->subscribeEvents(kHolder, {.fields = {kMessage}}, events.callback());
    ASSERT_TRUE(subscription);
    client.reset();
    EXPECT_THAT(events.all(), ElementsAre(Field(&EventNotice::kind, Kind::ended)));
    *subscription = Subscription();
}

TEST_F(ClientSubscriptionTest, MayEndWhenItHearsThatItsClientCloses) {
    std::optional<Subscription> mine;
    auto subscription = client->subscribeEvents(
        kHolder, {.fields = {kMessage}}, [&](const EventNotice& /*notice*/) { mine.reset(); });
    const auto other = client->subscribeEvents(kHolder, {.fields = {kMessage}}, events.callback());
    ASSERT_TRUE(subscription && other);
    mine = std::move(*subscription);
    client->close();
    EXPECT_FALSE(mine);
    EXPECT_EQ(events.all().size(), 1U);
}

TEST_F(ClientSubscriptionTest, RefusesWaitingCallsFromItsCallback) {
    std::promise<Errc> refusal;
    const auto subscription = client->subscribeEvents(
        kHolder, {.fields = {kMessage}}, [&](const EventNotice& /*notice*/) {
            refusal.set_value(client->read(kNumber).error().code);
        });
    ASSERT_TRUE(subscription);
    raiseEvents(1);
    EXPECT_EQ(refusal.get_future().get(), Errc::invalid_state);
}

TEST_F(ClientSubscriptionTest, LeavesNothingBehindWhenItsCallTimesOut) {
    server.pause();
    const auto subscription =
        client->subscribeEvents(kHolder, {.fields = {kMessage}}, events.callback(), 50ms);
    ASSERT_FALSE(subscription);
    EXPECT_EQ(subscription.error().code, Errc::timeout);
    server.resume();
    raiseEvents(1);
    Heard<EventNotice> others;
    const auto other = client->subscribeEvents(kHolder, {.fields = {kMessage}}, others.callback());
    ASSERT_TRUE(other) << other.error().message;
    raiseEvents(1);
    ASSERT_TRUE(others.waitFor(1));
    EXPECT_TRUE(events.all().empty());
}

}  // namespace
}  // namespace metier::opcua::testing
