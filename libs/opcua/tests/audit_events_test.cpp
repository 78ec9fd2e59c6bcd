// The audit events of the standard, as clients get them.
#include <gmock/gmock.h>

#include "audited_server.hpp"
#include "bare_client.hpp"

namespace metier::opcua {
namespace {

using namespace std::chrono_literals;
using ::testing::AllOf;
using testing::AuditedServer;
using ::testing::Each;
using ::testing::HasSubstr;
using testing::kArm;
using testing::kStart;

/// The fields of audit events that the tests ask for, in the order of the constants below.
const std::vector<BrowsePath> kSelected{
    {{0, "EventType"}},       {{0, "SourceNode"}}, {{0, "SourceName"}}, {{0, "Message"}},
    {{0, "Severity"}},        {{0, "Status"}},     {{0, "ServerId"}},   {{0, "ClientUserId"}},
    {{0, "ActionTimeStamp"}}, {{0, "MethodId"}},   {{0, "SessionId"}},  {{0, "InputArguments"}},
    {{0, "Certificate"}}};
enum Selected {
    kEventType,
    kSourceNode,
    kSourceName,
    kMessage,
    kSeverity,
    kStatus,
    kServerId,
    kClientUserId,
    kActionTimeStamp,
    kMethodId,
    kSessionId,
    kInputArguments,
    kCertificate,
};

/// The audit events that a client gets.
class AuditEvents {
public:
    explicit AuditEvents(Client& client, std::optional<NodeId> type = ids::kAuditEventType) {
        auto subscription =
            client.subscribeEvents(ids::kServer, {.fields = kSelected, .of_type = std::move(type)},
                                   [this](const EventNotice& notice) {
                                       const std::lock_guard lock(mutex_);
                                       if (notice.kind == EventNotice::Kind::event) {
                                           events_.push_back(notice.fields);
                                           changed_.notify_all();
                                       }
                                   });
        EXPECT_TRUE(subscription) << subscription.error().message;
        subscription_ = std::move(*subscription);
    }
    /// The first of a type. Fails at the deadline.
    testing::ReceivedEvent await(const NodeId& type) {
        const auto is_it = [&](const auto& event) { return event[kEventType] == Value::of(type); };
        std::unique_lock lock(mutex_);
        const auto found = [&] { return std::find_if(events_.begin(), events_.end(), is_it); };
        EXPECT_TRUE(changed_.wait_for(lock, 10s, [&] { return found() != events_.end(); }))
            << "no event of type " << type.toString() << " among " << events_.size();
        return found() == events_.end() ? testing::ReceivedEvent(kSelected.size()) : *found();
    }
    std::vector<testing::ReceivedEvent> all() {
        const std::lock_guard lock(mutex_);
        return events_;
    }

private:
    std::mutex mutex_;
    std::condition_variable changed_;
    std::vector<testing::ReceivedEvent> events_;
    Subscription subscription_;  // ends first
};

TEST_F(AuditedServer, SaysThatItAudits) {
    serve();
    testing::BareClient client;
    ASSERT_EQ(client.connect(server_->endpointUrl()), status::kGood);
    EXPECT_EQ(client.read(ids::kServerAuditing).value, Value::of(true));
    client.disconnect();
}

TEST_F(AuditedServer, RaisesAnEventOfTheStandardForACall) {
    serveClosed();
    const auto engineer = connected("Engineer");
    AuditEvents events(*engineer);
    ASSERT_FALSE(engineer->call(kArm, kStart, {Value::of("refuse")}));
    const auto event = events.await(ids::kAuditUpdateMethodEventType);
    EXPECT_EQ(event[kSourceNode], Value::of(ids::kServer));
    EXPECT_EQ(event[kSourceName], Value::of("Attribute/Call"));
    EXPECT_THAT(event[kMessage].toString(),
                AllOf(HasSubstr("Start of Arm (ns=2;s=Arm) by Engineer (Engineer)"),
                      HasSubstr(clientIdentity().certificate.thumbprint()),
                      HasSubstr("BadLocked: held by")));
    EXPECT_EQ(event[kStatus], Value::of(false));
    EXPECT_EQ(event[kServerId], Value::of(kServerUri));
    EXPECT_EQ(event[kClientUserId], Value::of("Engineer"));
    EXPECT_EQ(event[kMethodId], Value::of(kStart));
    EXPECT_EQ(event[kInputArguments], Value::of(std::vector<std::string>{"refuse"}));
    EXPECT_EQ(event[kActionTimeStamp].as<UtcTime>().has_value(), true);
}

TEST_F(AuditedServer, RaisesEventsOfLoginsAndPeersAndItsOwnActs) {
    serveClosed();
    const auto admin = connected("SecurityAdmin");
    AuditEvents events(*admin);
    ASSERT_FALSE(connect("Operator", "guess"));
    const auto login = events.await(ids::kAuditActivateSessionEventType);
    EXPECT_EQ(login[kClientUserId], Value::of("Operator"));
    EXPECT_EQ(login[kStatus], Value::of(false));
    EXPECT_TRUE(login[kSessionId].as<NodeId>());
    connected("Operator").reset();
    EXPECT_EQ(events.await(ids::kAuditSessionEventType)[kClientUserId], Value::of("Operator"));
    const auto stranger = identityOf("stranger");
    ASSERT_FALSE(connect("Operator", "secret", stranger));
    const auto& der = stranger.certificate.der();
    EXPECT_EQ(events.await(ids::kAuditCertificateUntrustedEventType)[kCertificate],
              Value::of(ByteString{{der.begin(), der.end()}}));
    ASSERT_TRUE(server_->call(
        [&] { server_->audit({.object = kArm, .event = "ControlLost", .text = "no heartbeat"}); }));
    EXPECT_THAT(events.await(ids::kAuditEventType)[kMessage].toString(),
                HasSubstr("ControlLost of Arm (ns=2;s=Arm) by the server: no heartbeat"));
}

// The stack sends an event to every subscriber; a subscriber that may not audit must read no
// content.
TEST_F(AuditedServer, HidesWhatEventsSayFromWhoMayNotAudit) {
    serveClosed();
    const auto engineer = connected("Engineer");
    const auto observer = connected("Observer");
    AuditEvents seen(*engineer);
    AuditEvents filtered(*observer);
    AuditEvents unfiltered(*observer, std::nullopt);
    const auto operates = connected("Operator");
    ASSERT_TRUE(operates->call(kArm, kStart, {Value::of("fast")}));
    EXPECT_EQ(seen.await(ids::kAuditUpdateMethodEventType)[kStatus], Value::of(true));
    // Behind all that came before, an event that everybody may read.
    ASSERT_TRUE(server_->call([&]() -> Result<void> {
        auto emitter = EventEmitter::create(*server_, ids::kSystemEventType, {});
        return emitter->emit({ids::kServer, "Server", {}, 1, {"", "end"}, {}}).map([](auto) {});
    }));
    unfiltered.await(ids::kSystemEventType);
    EXPECT_THAT(filtered.all(), Each(Each(Value())));
    auto events = unfiltered.all();
    events.pop_back();
    EXPECT_THAT(events, Each(Each(Value())));
}

}  // namespace
}  // namespace metier::opcua
