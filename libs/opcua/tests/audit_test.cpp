// Audit records that a server's hook gets of commands, and of denied ones.
#include <gmock/gmock.h>

#include "audited_server.hpp"
#include "bare_client.hpp"
#include "server/rate_limit.hpp"

namespace metier::opcua {
namespace {

using namespace std::chrono_literals;
using ::testing::AllOf;
using testing::AuditedServer;
using ::testing::ElementsAre;
using ::testing::EndsWith;
using ::testing::Field;
using ::testing::HasSubstr;
using testing::kArm;
using testing::kBeat;
using testing::kStart;
using testing::kTell;
using ::testing::Not;
using ::testing::SizeIs;
using ::testing::StartsWith;

TEST_F(AuditedServer, TellsWhoCalledWhatAndWhatCameOfIt) {
    serve();
    testing::BareClient client;
    ASSERT_EQ(client.connect(server_->endpointUrl()), status::kGood);
    ASSERT_EQ(client.call(kArm, kStart, {Value::of("fast")}).status, status::kGood);
    ASSERT_EQ(client.call(kArm, kStart, {Value::of("refuse")}).status, status::kBadLocked);
    const auto calls = records_.of(AuditKind::called);
    ASSERT_THAT(calls, SizeIs(2));
    EXPECT_EQ(calls[0].event, "Start");
    EXPECT_EQ(calls[0].object, kArm);
    EXPECT_EQ(calls[0].object_name, "Arm");
    EXPECT_EQ(calls[0].method, kStart);
    EXPECT_THAT(calls[0].inputs, ElementsAre("fast"));
    EXPECT_EQ(calls[0].status, status::kGood);
    EXPECT_FALSE(calls[0].session.id.isNull());
    EXPECT_FALSE(calls[0].session.application_uri.empty());
    EXPECT_LT(std::chrono::system_clock::now() - calls[0].time, 60s);
    EXPECT_EQ(calls[1].status, status::kBadLocked);
    EXPECT_THAT(calls[1].text, AllOf(StartsWith("held by"), Not(HasSubstr("\x1b"))));
    client.disconnect();
}

TEST_F(AuditedServer, LeavesOutWhatOnlyTellsOrRenews) {
    serve();
    testing::BareClient client;
    ASSERT_EQ(client.connect(server_->endpointUrl()), status::kGood);
    ASSERT_EQ(client.call(kArm, kTell, {}).status, status::kGood);
    ASSERT_EQ(client.call(kArm, kBeat, {}).status, status::kGood);
    ASSERT_EQ(client.call(kArm, kStart, {Value::of(1.5)}).status, status::kGood);
    EXPECT_THAT(records_.of(AuditKind::called), ElementsAre(Field(&AuditRecord::event, "Start")));
    client.disconnect();
}

TEST_F(AuditedServer, KeepsInputsShort) {
    serve();
    testing::BareClient client;
    ASSERT_EQ(client.connect(server_->endpointUrl()), status::kGood);
    client.call(kArm, kStart, {Value::of(std::vector<double>(10'000, 1.0))});
    client.call(kArm, kStart, {Value::of(std::string(399, 'a') + "\u00e4 and on and on")});
    client.call(kArm, kStart, {Value::of("\x1b[2Jwiped")});
    const auto calls = records_.of(AuditKind::called);
    ASSERT_THAT(calls, SizeIs(3));
    EXPECT_THAT(calls[0].inputs, ElementsAre("Double[10000]"));
    EXPECT_THAT(calls[1].inputs, ElementsAre(std::string(399, 'a') + "..."));
    EXPECT_THAT(calls[2].inputs, ElementsAre(AllOf(EndsWith("[2Jwiped"), Not(HasSubstr("\x1b")))));
    client.disconnect();
}

TEST_F(AuditedServer, TellsWhatItDidByItself) {
    serve();
    ASSERT_TRUE(server_->call(
        [&] { server_->audit({.object = kArm, .event = "ControlLost", .text = "no heartbeat"}); }));
    const auto acts = records_.of(AuditKind::acted);
    ASSERT_THAT(acts, SizeIs(1));
    EXPECT_EQ(acts[0].event, "ControlLost");
    EXPECT_EQ(acts[0].object_name, "Arm");
    EXPECT_EQ(acts[0].text, "no heartbeat");
    EXPECT_TRUE(acts[0].session.id.isNull());
}

TEST_F(AuditedServer, TellsWhoCameAndWent) {
    serveClosed();
    connected("Operator").reset();
    const auto ended = records_.await(AuditKind::session_closed, 1);
    ASSERT_THAT(ended, SizeIs(1));
    const auto logins = records_.of(AuditKind::login);
    ASSERT_THAT(logins, SizeIs(1));
    EXPECT_EQ(logins[0].session.id, ended[0].session.id);
    EXPECT_EQ(logins[0].session.user, "Operator");
    EXPECT_EQ(logins[0].session.role, security::Role::operator_);
    EXPECT_EQ(logins[0].session.application_uri, "urn:test:client");
    EXPECT_EQ(logins[0].session.thumbprint, clientIdentity().certificate.thumbprint());
}

TEST_F(AuditedServer, TellsWhoWasNotLetIn) {
    serveClosed();
    ASSERT_FALSE(connect("Operator", "guess"));
    const auto refused = records_.of(AuditKind::login_refused);
    ASSERT_THAT(refused, SizeIs(1));
    EXPECT_EQ(refused[0].session.user, "Operator");
    EXPECT_EQ(refused[0].session.thumbprint, clientIdentity().certificate.thumbprint());
    EXPECT_EQ(refused[0].status, status::kBadUserAccessDenied);
    EXPECT_EQ(refused[0].text, "wrong password");
    EXPECT_THAT(records_.of(AuditKind::login), SizeIs(0));
}

TEST_F(AuditedServer, TellsWhichPeerItDoesNotTrust) {
    serveClosed();
    const auto stranger = identityOf("stranger");
    ASSERT_FALSE(connect("Operator", "secret", stranger));
    const auto refused = records_.await(AuditKind::peer_refused, 1);
    ASSERT_FALSE(refused.empty());
    EXPECT_EQ(refused[0].session.thumbprint, stranger.certificate.thumbprint());
    EXPECT_EQ(refused[0].session.application_uri, "urn:test:stranger");
    EXPECT_EQ(refused[0].status, status::kBadCertificateUntrusted);
    EXPECT_EQ(refused[0].certificate, stranger.certificate.der());
}

TEST_F(AuditedServer, TellsWhoMayNotCommand) {
    serveClosed();
    const auto observer = connected("Observer");
    ASSERT_FALSE(observer->call(kArm, kStart, {Value::of(1.0)}));
    const auto denied = records_.of(AuditKind::denied);
    ASSERT_THAT(denied, SizeIs(1));
    EXPECT_EQ(denied[0].status, status::kBadUserAccessDenied);
    EXPECT_EQ(denied[0].method_name, "Start");
    EXPECT_EQ(denied[0].object_name, "Arm");
    EXPECT_EQ(denied[0].session.user, "Observer");
    EXPECT_THAT(records_.of(AuditKind::called), SizeIs(0));
}

// A peer that anybody can be must not fill a disk.
TEST_F(AuditedServer, CountsWhatComesTooOften) {
    serveClosed();
    auto observer = connected("Observer");
    constexpr std::size_t kCalls = 150;
    for (std::size_t i = 0; i < kCalls; ++i) {
        ASSERT_FALSE(observer->call(kArm, kStart, {Value::of(1.0)}));
    }
    const auto noted = records_.of(AuditKind::denied).size();
    EXPECT_GE(noted, 100U);
    observer.reset();
    server_->stop();
    std::size_t left_out = 0;
    for (const auto& record : records_.of(AuditKind::left_out)) {
        EXPECT_THAT(record.text, EndsWith(" more of Denied"));
        left_out += std::stoul(record.text);
    }
    EXPECT_EQ(records_.of(AuditKind::denied).size() + left_out, kCalls);
    EXPECT_GT(left_out, 0U);
}

TEST(RateLimit, LetsABurstPassAndThenSoManyPerSecond) {
    RateLimit limit(3, 0.5);
    SteadyTime now{1h};
    for (int i = 0; i < 3; ++i) {
        EXPECT_TRUE(limit.take(now)) << i;
    }
    EXPECT_FALSE(limit.take(now));
    EXPECT_FALSE(limit.take(now += 1s));
    EXPECT_TRUE(limit.take(now += 1s));
    EXPECT_FALSE(limit.take(now));
    now += 24h;
    for (int i = 0; i < 3; ++i) {
        EXPECT_TRUE(limit.take(now)) << i;
    }
    EXPECT_FALSE(limit.take(now));
}

}  // namespace
}  // namespace metier::opcua
