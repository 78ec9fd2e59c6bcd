#include "metier/opcua/event_emitter.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <ctime>
#include <set>

#include "bare_client.hpp"

namespace metier::opcua {
namespace {

using testing::BareClient;
using ::testing::HasSubstr;
using testing::makeServer;
using testing::ReceivedEvent;
using testing::testOptions;
using namespace std::chrono_literals;

const NodeId kDevice{2, "Device"};
const NodeId kSkill{2, "Device.Skill"};
const UtcTime kWhen{std::chrono::milliseconds(1'700'000'000'123)};
const std::vector<BrowsePath> kTransitionFields{
    {{0, "FromState"}}, {{0, "ToState"}}, {{0, "ToState"}, {0, "Id"}}, {{0, "IntermediateResult"}}};

/// The fields the tests select, in the order of the constants below.
const std::vector<BrowsePath> kSelected{{{0, "EventId"}},
                                        {{0, "EventType"}},
                                        {{0, "SourceNode"}},
                                        {{0, "SourceName"}},
                                        {{0, "Time"}},
                                        {{0, "ReceiveTime"}},
                                        {{0, "Message"}},
                                        {{0, "Severity"}},
                                        {{0, "FromState"}},
                                        {{0, "ToState"}},
                                        {{0, "ToState"}, {0, "Id"}},
                                        {{0, "IntermediateResult"}}};
enum Selected {
    kEventId,
    kEventType,
    kSourceNode,
    kSourceName,
    kTime,
    kReceiveTime,
    kMessage,
    kSeverity,
    kFromState,
    kToState,
    kToStateId,
    kIntermediateResult,
};

Event transition(std::uint32_t number) {
    Event event;
    event.source = kSkill;
    event.source_name = "Skill";
    event.time = kWhen;
    event.severity = 100;
    event.message = {"en", "moved on"};
    event.fields = {Value::of(LocalizedText{"en", "Ready"}),
                    Value::of(LocalizedText{"en", "Running"}), Value::of(NodeId(0, 2400U)),
                    Value::of(number)};
    return event;
}

/// A server with a Skill on a Device, both notifiers, and an emitter of Program transitions.
class EventEmitterTest : public ::testing::Test {
protected:
    explicit EventEmitterTest(const ServerOptions& options = testOptions())
        : server_(makeServer(options)), emitter_(prepare()) {
        EXPECT_TRUE(server_->start());
        EXPECT_EQ(client_.connect(server_->endpointUrl()), status::kGood);
    }
    ~EventEmitterTest() override {
        client_.disconnect();  // first: a bare client waits 5 s for a server that has ended
        server_->stop();
    }

    EventEmitter prepare() {
        auto& nodes = server_->nodes();
        const auto add = [&](const NodeId& id, const NodeId& parent, const char* name) {
            EXPECT_TRUE(nodes.addObject({{id, parent, ids::kHasComponent, {2, name}},
                                         ids::kBaseObjectType,
                                         EventNotifier::subscribable}));
        };
        EXPECT_TRUE(nodes.addObject({{kDevice, ids::kObjectsFolder, ids::kOrganizes, {2, "Device"}},
                                     ids::kBaseObjectType,
                                     EventNotifier::subscribable}));
        add(kSkill, kDevice, "Skill");
        EXPECT_TRUE(nodes.addReference(ids::kServer, ids::kHasNotifier, kDevice));
        EXPECT_TRUE(nodes.addReference(kDevice, ids::kHasEventSource, kSkill));
        return EventEmitter::create(*server_, ids::kProgramTransitionEventType, kTransitionFields)
            .value();
    }

    Result<ByteString> emit(const Event& event) {
        return server_->call([&] { return emitter_.emit(event); });
    }

    std::unique_ptr<Server> server_;
    EventEmitter emitter_;
    BareClient client_;
};

TEST_F(EventEmitterTest, EveryFieldReachesTheClient) {
    std::vector<ReceivedEvent> events;
    ASSERT_GT(client_.subscribe(100), 0);
    ASSERT_EQ(client_.watchEvents(kSkill, kSelected, events), status::kGood);
    const auto before = std::chrono::system_clock::now();
    const auto id = emit(transition(7));
    ASSERT_TRUE(id) << id.error().message;
    ASSERT_TRUE(client_.runUntil([&] { return !events.empty(); }));
    const auto& event = events[0];
    EXPECT_EQ(event[kEventId], Value::of(*id));
    EXPECT_EQ(event[kEventType], Value::of(ids::kProgramTransitionEventType));
    EXPECT_EQ(event[kSourceNode], Value::of(kSkill));
    EXPECT_EQ(event[kSourceName], Value::of("Skill"));
    EXPECT_EQ(event[kTime], Value::of(kWhen));
    EXPECT_GE(event[kReceiveTime].as<UtcTime>().value(), before - 1ms);
    EXPECT_EQ(event[kMessage], Value::of(LocalizedText{"en", "moved on"}));
    EXPECT_EQ(event[kSeverity], Value::of(std::uint16_t{100}));
    EXPECT_EQ(event[kFromState], Value::of(LocalizedText{"en", "Ready"}));
    EXPECT_EQ(event[kToState], Value::of(LocalizedText{"en", "Running"}));
    EXPECT_EQ(event[kToStateId], Value::of(NodeId(0, 2400U)));
    EXPECT_EQ(event[kIntermediateResult], Value::of(std::uint32_t{7}));
}

/// Keeps the processor busy, by the clock of this program's work.
void work(double seconds) {
    const auto end = std::clock() + static_cast<std::clock_t>(seconds * CLOCKS_PER_SEC);
    while (std::clock() < end) {
    }
}

// The server refuses to read for a message that takes more than 20 ms; the fields were Null then.
TEST_F(EventEmitterTest, AMessageThatTakesLongRaisesItsEventsWhole) {
    std::vector<ReceivedEvent> events;
    ASSERT_GT(client_.subscribe(100), 0);
    ASSERT_EQ(client_.watchEvents(kSkill, kSelected, events), status::kGood);
    const NodeId method(2, "long");
    ASSERT_TRUE(server_->call([&] {
        return server_->nodes().addMethod(
            {.node = {method, kSkill, ids::kHasComponent, {2, "Long"}},
             .handler = [&](const CallContext&,
                            std::span<const Value>) -> Result<std::vector<Value>> {
                 work(0.1);
                 EXPECT_TRUE(emitter_.emit(transition(7)));
                 return std::vector<Value>();
             }});
    }));
    ASSERT_EQ(client_.call(kSkill, method, {}).status, status::kGood);
    ASSERT_TRUE(client_.runUntil([&] { return !events.empty(); }));
    EXPECT_EQ(events[0][kSourceNode], Value::of(kSkill));
    EXPECT_EQ(events[0][kIntermediateResult], Value::of(std::uint32_t{7}));
}

TEST_F(EventEmitterTest, ASubscriptionWithoutASessionHarmsNoServer) {
    std::vector<ReceivedEvent> events;
    ASSERT_GT(client_.subscribe(100), 0);
    ASSERT_EQ(client_.watchEvents(kSkill, kSelected, events), status::kGood);
    ASSERT_EQ(client_.closeSessionWithoutSubscriptions(), status::kGood);
    const auto raised = emit(transition(7));
    EXPECT_TRUE(raised) << raised.error().message;
    BareClient other;
    ASSERT_EQ(other.connect(server_->endpointUrl()), status::kGood);
    EXPECT_TRUE(other.read(NodeId(0, 2258U)).status.isGood()) << "the server lives";
    other.disconnect();
}

TEST_F(EventEmitterTest, EveryNotifierAboveTheSourcePassesItOn) {
    std::vector<ReceivedEvent> skill;
    std::vector<ReceivedEvent> device;
    std::vector<ReceivedEvent> server;
    ASSERT_GT(client_.subscribe(100), 0);
    ASSERT_EQ(client_.watchEvents(kSkill, kSelected, skill), status::kGood);
    ASSERT_EQ(client_.watchEvents(kDevice, kSelected, device), status::kGood);
    ASSERT_EQ(client_.watchEvents(ids::kServer, kSelected, server), status::kGood);
    ASSERT_TRUE(emit(transition(1)));
    ASSERT_TRUE(
        client_.runUntil([&] { return !skill.empty() && !device.empty() && !server.empty(); }));
    EXPECT_EQ(skill[0], device[0]);
    EXPECT_EQ(skill[0], server[0]);
}

TEST_F(EventEmitterTest, ABurstKeepsItsOrderAndEachEventItsOwnFields) {
    constexpr std::uint32_t kBurst = 1000;
    std::vector<ReceivedEvent> events;
    ASSERT_GT(client_.subscribe(100), 0);
    ASSERT_EQ(client_.watchEvents(kSkill, kSelected, events), status::kGood);
    const auto raised = server_->call([&]() -> Result<> {
        for (std::uint32_t i = 0; i < kBurst; ++i) {
            METIER_TRY(emitter_.emit(transition(i)));
        }
        return {};
    });
    ASSERT_TRUE(raised) << raised.error().message;
    ASSERT_TRUE(client_.runUntil([&] { return events.size() >= kBurst; }));
    std::set<ByteString> ids;
    for (std::uint32_t i = 0; i < kBurst; ++i) {
        EXPECT_EQ(events[i][kIntermediateResult], Value::of(i));
        ids.insert(events[i][kEventId].as<ByteString>().value());
    }
    EXPECT_EQ(ids.size(), kBurst);
}

TEST_F(EventEmitterTest, PublishesAtOnceWhateverTheInterval) {
    std::vector<ReceivedEvent> events;
    ASSERT_EQ(client_.subscribe(10'000), 10'000);
    ASSERT_EQ(client_.watchEvents(kSkill, kSelected, events), status::kGood);
    client_.runUntil([] { return false; }, 20ms);  // the first PublishRequests are on their way
    ASSERT_TRUE(emit(transition(1)));
    EXPECT_TRUE(client_.runUntil([&] { return !events.empty(); }, 5s));
}

TEST_F(EventEmitterTest, RaisesNothingWhenAFieldHasTheWrongType) {
    std::vector<ReceivedEvent> events;
    ASSERT_GT(client_.subscribe(10), 0);
    ASSERT_EQ(client_.watchEvents(kSkill, kSelected, events), status::kGood);
    auto wrong = transition(1);
    wrong.fields[1] = Value::of(5.0);
    const auto refused = emit(wrong);
    EXPECT_EQ(refused.error().code, Errc::type_mismatch);
    EXPECT_THAT(refused.error().message, HasSubstr("Double in event field ToState"));
    ASSERT_TRUE(emit(transition(2)));
    ASSERT_TRUE(client_.runUntil([&] { return !events.empty(); }));
    EXPECT_EQ(events[0][kIntermediateResult], Value::of(std::uint32_t{2}));
}

TEST_F(EventEmitterTest, RefusesTheWrongNumberOfFields) {
    auto few = transition(1);
    few.fields.pop_back();
    const auto refused = emit(few);
    EXPECT_EQ(refused.error().code, Errc::invalid_argument);
    EXPECT_THAT(refused.error().message, HasSubstr("3 event fields where 4"));
}

TEST_F(EventEmitterTest, RefusesASourceThatDoesNotExist) {
    auto lost = transition(1);
    lost.source = NodeId(2, "none");
    EXPECT_EQ(emit(lost).error().code, Errc::not_found);
}

TEST_F(EventEmitterTest, RefusesTypesAndFieldsThatAreNone) {
    const auto create = [&](const NodeId& type, const std::vector<BrowsePath>& fields) {
        return server_->call([&]() -> Result<> {
            auto made = EventEmitter::create(*server_, type, fields);
            return made ? Result<>() : fail(made.error());
        });
    };
    EXPECT_EQ(create(ids::kFolderType, {}).error().code, Errc::invalid_argument);
    const auto missing = create(ids::kBaseEventType, {{{0, "Mood"}}});
    EXPECT_EQ(missing.error().code, Errc::not_found);
    EXPECT_THAT(missing.error().message, HasSubstr("0:Mood"));
}

class EventsAtInterval : public EventEmitterTest {
protected:
    static ServerOptions strict() {
        auto options = testOptions();
        options.event_publishing = EventPublishing::at_interval;
        return options;
    }
    EventsAtInterval() : EventEmitterTest(strict()) {}
};

TEST_F(EventsAtInterval, ComeWithTheSubscriptionsInterval) {
    std::vector<ReceivedEvent> events;
    ASSERT_EQ(client_.subscribe(300), 300);
    ASSERT_EQ(client_.watchEvents(kSkill, kSelected, events), status::kGood);
    ASSERT_TRUE(emit(transition(0)));
    ASSERT_TRUE(client_.runUntil([&] { return !events.empty(); }));
    constexpr std::uint32_t kEvents = 7;
    std::uint32_t waited = 0;
    for (std::uint32_t i = 1; i <= kEvents; ++i) {
        const auto tick = std::chrono::steady_clock::now();  // or later, on a busy machine
        ASSERT_TRUE(emit(transition(i)));
        ASSERT_TRUE(client_.runUntil([&] { return events.size() == i + 1; }));
        waited += std::chrono::steady_clock::now() - tick > 150ms ? 1 : 0;
    }
    EXPECT_GT(2 * waited, kEvents);
}

TEST_F(EventEmitterTest, ValuesTheServerWritesReachDataSubscriptions) {
    const NodeId variable(2, "Device.Level");
    ASSERT_TRUE(server_->call([&] {
        VariableSpec spec;
        spec.node = {variable, kDevice, ids::kHasComponent, {2, "Level"}};
        spec.data_type = ids::kDouble;
        return server_->nodes().addVariable(spec);
    }));
    std::vector<DataValue> values;
    ASSERT_EQ(client_.subscribe(10), 10);
    ASSERT_EQ(client_.watchValue(variable, 10, values), status::kGood);
    ASSERT_TRUE(client_.runUntil([&] { return values.size() == 1; }));
    ASSERT_TRUE(server_->call([&] { return server_->nodes().write(variable, Value::of(0.5)); }));
    ASSERT_TRUE(client_.runUntil([&] { return values.size() == 2; }));
    EXPECT_EQ(values[1].value, Value::of(0.5));
}

}  // namespace
}  // namespace metier::opcua
