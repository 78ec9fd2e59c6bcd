// Servers that are closed: who is let in, by which connection, and who is not.
#include "metier/opcua/security.hpp"

#include <gmock/gmock.h>

#include <filesystem>
#include <map>
#include <mutex>

#include "common/peer_check.hpp"
#include "metier/opcua/client.hpp"
#include "metier/opcua/discovery.hpp"
#include "metier/opcua/server.hpp"

namespace metier::opcua {
namespace {

using ::testing::HasSubstr;

constexpr const char* kServerUri = "urn:test:server";

security::Identity identityOf(const std::string& name) {
    return security::makeIdentity({.application_name = name, .application_uri = "urn:test:" + name},
                                  std::chrono::system_clock::now())
        .value();
}

/// Two identities for all tests: to make a key takes a while.
const security::Identity& serverIdentity() {
    static const auto identity = identityOf("server");
    return identity;
}
const security::Identity& clientIdentity() {
    static const auto identity = identityOf("client");
    return identity;
}

class ClosedServer : public ::testing::Test {
protected:
    ClosedServer() {
        trustIn("server", clientIdentity());
        trustIn("client", serverIdentity());
        start();
    }

    static std::filesystem::path emptyFolder() {
        const auto* name = ::testing::UnitTest::GetInstance()->current_test_info()->name();
        auto folder = std::filesystem::path(::testing::TempDir()) / "closed_server" / name;
        std::filesystem::remove_all(folder);
        return folder;
    }
    void trustIn(const std::string& who, const security::Identity& peer) {
        ASSERT_TRUE(security::TrustStore::open(folder_ / who).value().trust(peer.certificate));
    }
    void start(std::optional<DiscoveryService> discovery = std::nullopt) {
        ServerOptions options;
        options.discovery = discovery;
        options.application_uri = kServerUri;
        options.port = 0;
        options.on_audit = [this](const AuditRecord& record) {
            if (record.kind == AuditKind::denied) {
                const std::lock_guard lock(mutex_);
                denials_.push_back(record);
            }
        };
        options.security =
            ServerSecurity{.credentials = {serverIdentity(), folder_ / "server"},
                           .authenticate = [this](const Login& login) { return admit(login); },
                           .on_refused =
                               [this](const RefusedPeer& peer) {
                                   const std::lock_guard lock(mutex_);
                                   refused_.push_back(peer.refusal);
                               }};
        auto server = Server::create(std::move(options));
        ASSERT_TRUE(server) << server.error().message;
        server_ = std::move(*server);
        const auto started = server_->start();
        ASSERT_TRUE(started) << started.error().message;
    }

    Result<Admission> admit(const Login& login) const {
        const auto user = users_.find(login.user);
        if (user == users_.end() || login.password != "secret" || login.thumbprint.empty()) {
            return fail(Errc::access_denied, "wrong");
        }
        return Admission{login.user, user->second};
    }
    ClientOptions options(const security::Identity& identity = clientIdentity()) const {
        ClientOptions options;
        options.security = Credentials{identity, folder_ / "client"};
        options.user = UserName{"operator", "secret"};
        return options;
    }
    Answer<std::unique_ptr<Client>> connect(const ClientOptions& options) const {
        return Client::connect(server_->endpointUrl(), options);
    }
    void addMethod(const NodeId& id, MethodEffect effect, Session* caller = nullptr) {
        const auto added = server_->call([&]() -> Result<void> {
            auto& nodes = server_->nodes();
            const auto handler = [caller](const CallContext& context,
                                          std::span<const Value>) -> Result<std::vector<Value>> {
                if (caller != nullptr) {
                    *caller = context.session;
                }
                return std::vector<Value>();
            };
            const auto name = id.toString();
            const auto node =
                nodes.addMethod({.node = {id, ids::kObjectsFolder, ids::kHasComponent, {1, name}},
                                 .inputs = {},
                                 .outputs = {},
                                 .handler = handler});
            return node ? nodes.setMethod(id, handler, effect) : fail(node.error());
        });
        ASSERT_TRUE(added) << added.error().message;
    }
    security::RefusalKind lastRefusal() {
        const std::lock_guard lock(mutex_);
        return refused_.back().kind;
    }

    const std::filesystem::path folder_ = emptyFolder();
    std::mutex mutex_;
    std::vector<security::CertificateRefusal> refused_;
    std::map<std::string, security::Role> users_{{"observer", security::Role::observer},
                                                 {"operator", security::Role::operator_},
                                                 {"engineer", security::Role::engineer},
                                                 {"admin", security::Role::security_admin}};
    std::vector<AuditRecord> denials_;
    std::unique_ptr<Server> server_;
};

TEST_F(ClosedServer, ServesWhomItTrustsAndKnows) {
    const auto client = connect(options());
    ASSERT_TRUE(client) << client.error().message;
    const auto time = (*client)->read(NodeId(0, 2258U));  // CurrentTime
    EXPECT_TRUE(time) << time.error().message;
}

TEST_F(ClosedServer, KnowsItsClientsByTheirCertificates) {
    const NodeId who(1, "who");
    Session seen;
    addMethod(who, MethodEffect::commands, &seen);
    const auto client = connect(options());
    ASSERT_TRUE(client) << client.error().message;
    ASSERT_TRUE((*client)->call(ids::kObjectsFolder, who));
    EXPECT_EQ(seen.user, "operator");
    EXPECT_EQ(seen.role, security::Role::operator_);
    EXPECT_EQ(seen.thumbprint, clientIdentity().certificate.thumbprint());
    EXPECT_EQ(seen.application_uri, "urn:test:client");
}

struct Allowed {
    const char* user;
    bool commands;
};
class ClosedServerFor : public ClosedServer, public ::testing::WithParamInterface<Allowed> {};

// Everybody who is let in reads, browses and asks; operators and engineers also write and command.
TEST_P(ClosedServerFor, AllowsWhatARoleMayDo) {
    const NodeId command(1, "command");
    const NodeId question(1, "question");
    const NodeId variable(1, "variable");
    addMethod(command, MethodEffect::commands);
    addMethod(question, MethodEffect::tells);
    ASSERT_TRUE(server_->call([&] {
        VariableSpec spec;
        spec.node = {variable, ids::kObjectsFolder, ids::kHasComponent, {1, "variable"}};
        spec.data_type = ids::kDouble;
        spec.value = Value::of(1.0);
        spec.access = Access::read_write;
        return server_->nodes().addVariable(spec);
    }));
    auto mine = options();
    mine.user->name = GetParam().user;
    const auto client = connect(mine);
    ASSERT_TRUE(client) << client.error().message;

    EXPECT_TRUE((*client)->read(variable));
    EXPECT_TRUE((*client)->browse({.node = ids::kObjectsFolder}));
    EXPECT_TRUE((*client)->call(ids::kObjectsFolder, question));
    const auto expected = GetParam().commands ? status::kGood : status::kBadUserAccessDenied;
    const auto written = (*client)->write(variable, Value::of(2.0));
    EXPECT_EQ(written ? status::kGood : written.error().status, expected);
    const auto called = (*client)->call(ids::kObjectsFolder, command);
    EXPECT_EQ(called ? status::kGood : called.error().status, expected);
    EXPECT_EQ((*client)->readUserExecutable(command), GetParam().commands);
    const std::lock_guard lock(mutex_);
    ASSERT_EQ(denials_.size(), GetParam().commands ? 0U : 1U);
    if (!denials_.empty()) {
        EXPECT_EQ(denials_.front().session.user, GetParam().user);
        EXPECT_EQ(denials_.front().method, command);
    }
}

TEST_P(ClosedServerFor, ShowsTheCertificatesOfOthersToThoseAloneWhoAudit) {
    auto mine = options();
    mine.user->name = GetParam().user;
    const auto client = connect(mine);
    ASSERT_TRUE(client) << client.error().message;
    const NodeId session_security_diagnostics_array(0, 3708U);
    const auto read = (*client)->read(session_security_diagnostics_array);
    const std::string_view user = GetParam().user;
    const bool audits = user == "engineer" || user == "admin";
    EXPECT_EQ(read.has_value(), audits);
    if (!audits) {
        EXPECT_EQ(read.error().status, status::kBadUserAccessDenied);
    }
}

INSTANTIATE_TEST_SUITE_P(Roles, ClosedServerFor,
                         ::testing::Values(Allowed{"observer", false}, Allowed{"operator", true},
                                           Allowed{"engineer", true}, Allowed{"admin", false}),
                         [](const auto& of) { return std::string(of.param.user); });

TEST_F(ClosedServer, LetsNobodyInWithoutSecurity) {
    ClientOptions open;
    open.user = UserName{"operator", "secret"};
    const auto client = connect(open);
    ASSERT_FALSE(client);
}

TEST_F(ClosedServer, TellsAnybodyOfItsEndpoints) {
    const auto servers = findServers(server_->endpointUrl());
    ASSERT_TRUE(servers) << servers.error().message;
    ASSERT_EQ(servers->size(), 1U);
    EXPECT_EQ(servers->front().application_uri, kServerUri);
}

TEST_F(ClosedServer, LetsNobodyInWithoutAName) {
    auto nameless = options();
    nameless.user.reset();
    EXPECT_FALSE(connect(nameless));
}

TEST_F(ClosedServer, LetsNobodyInWithAWrongPassword) {
    auto wrong = options();
    wrong.user->password = "Secret";
    const auto refused = connect(wrong);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, Errc::access_denied);
}

TEST_F(ClosedServer, GivesOneApplicationSoManySessionsAndNoMore) {
    const auto other = identityOf("other");
    trustIn("server", other);
    std::vector<std::unique_ptr<Client>> clients;
    for (int i = 0; i < ServerLimits().sessions_per_application; ++i) {
        auto client = connect(options());
        ASSERT_TRUE(client) << client.error().message;
        clients.push_back(std::move(*client));
    }
    const auto one_more = connect(options());
    ASSERT_FALSE(one_more);
    EXPECT_EQ(one_more.error().status, status::kBadTooManySessions);
    EXPECT_TRUE(connect(options(other)));

    ASSERT_TRUE(clients.back()->close());
    const auto instead = connect(options());
    EXPECT_TRUE(instead) << instead.error().message;
}

TEST_F(ClosedServer, LetsFailedLoginsTakeNoSessionsOfTheirApplication) {
    auto wrong = options();
    wrong.user->password = "Secret";
    for (int i = 0; i < ServerLimits().sessions_per_application; ++i) {
        ASSERT_EQ(connect(wrong).error().code, Errc::access_denied);
    }
    const auto right = connect(options());
    EXPECT_TRUE(right) << right.error().message;
}

TEST_F(ClosedServer, RefusesAStrangerAndTellsOfIt) {
    const auto stranger = identityOf("stranger");
    EXPECT_FALSE(connect(options(stranger)));
    EXPECT_EQ(lastRefusal(), security::RefusalKind::untrusted);
}

TEST_F(ClosedServer, TakesAStrangerOnceHeIsTrusted) {
    const auto stranger = identityOf("stranger");
    EXPECT_FALSE(connect(options(stranger)));
    trustIn("server", stranger);
    const auto client = connect(options(stranger));
    EXPECT_TRUE(client) << client.error().message;
}

TEST_F(ClosedServer, IsNotTrustedByAClientThatDoesNotKnowIt) {
    ASSERT_TRUE(security::TrustStore::open(folder_ / "client")
                    .value()
                    .distrust(serverIdentity().certificate.thumbprint()));
    const auto refused = connect(options());
    ASSERT_FALSE(refused);
    EXPECT_THAT(refused.error().message,
                HasSubstr(serverIdentity().certificate.thumbprint() + ") is not trusted"));
}

TEST_F(ClosedServer, IsKeptToBeDecidedOnByAClientThatDoesNotKnowIt) {
    auto store = security::TrustStore::open(folder_ / "client").value();
    const auto& thumbprint = serverIdentity().certificate.thumbprint();
    store.distrust(thumbprint).value();
    std::filesystem::remove_all(folder_ / "client" / "rejected");
    EXPECT_FALSE(connect(options()));
    ASSERT_TRUE(store.trustRejected(thumbprint));
    const auto client = connect(options());
    EXPECT_TRUE(client) << client.error().message;
}

TEST_F(ClosedServer, GoesOnWithARenewedCertificate) {
    const auto before = connect(options()).value();
    const auto now = std::chrono::system_clock::now();
    const auto renewed =
        security::makeSuccessor(serverIdentity(), std::chrono::days(10), now).value();
    const auto done = server_->call([&] { return server_->renewIdentity(renewed); });
    ASSERT_TRUE(done) << done.error().message;
    const auto refused = connect(options());
    ASSERT_FALSE(refused) << "its client trusts the former alone";
    EXPECT_THAT(refused.error().message, HasSubstr(renewed.certificate.thumbprint()));
    trustIn("client", renewed);
    const auto after = connect(options());
    EXPECT_TRUE(after) << after.error().message;
    EXPECT_TRUE(before->read(NodeId(0, 2258U))) << "open connections stay";
}

TEST_F(ClosedServer, DoesNotGoOnAsAnotherServer) {
    const auto done = server_->call([&] { return server_->renewIdentity(clientIdentity()); });
    ASSERT_FALSE(done);
    EXPECT_THAT(done.error().message, HasSubstr("is of \"urn:test:client\", not of"));
    EXPECT_TRUE(connect(options()));
}

TEST_F(ClosedServer, IsConnectedToWithThePresentIdentityOfAClient) {
    const auto mine = folder_ / "own";
    auto renewing = options(identityOf("former"));
    renewing.security->identity_folder = mine;
    EXPECT_FALSE(connect(renewing)) << "nothing there, and the former is not trusted";
    ASSERT_TRUE(security::saveIdentity(mine, clientIdentity()));
    const auto client = connect(renewing);
    EXPECT_TRUE(client) << client.error().message;
}

/// A closed Local Discovery Server in place of the other.
class ClosedDiscovery : public ClosedServer {
protected:
    ClosedDiscovery() {
        server_.reset();
        discovery_.forget_after = std::chrono::seconds(60);
        start(discovery_);
    }
    static ServerRegistration arm() {
        return {.application_uri = "urn:test:client",
                .name = "arm",
                .discovery_urls = {"opc.tcp://127.0.0.1:1"}};
    }

    DiscoveryService discovery_;
};

TEST_F(ClosedDiscovery, RegistersWhomItTrusts) {
    const auto told =
        registerServer(server_->endpointUrl(), arm(), std::chrono::seconds(5), options().security);
    ASSERT_TRUE(told) << told.error().message;
    EXPECT_EQ(findServers(server_->endpointUrl()).value().size(), 2U);
}

TEST_F(ClosedDiscovery, RegistersNobodyElse) {
    EXPECT_FALSE(registerServer(server_->endpointUrl(), arm()));
    const auto stranger = options(identityOf("stranger")).security;
    EXPECT_FALSE(registerServer(server_->endpointUrl(), arm(), std::chrono::seconds(5), stranger));
    EXPECT_EQ(findServers(server_->endpointUrl()).value().size(), 1U);
}

TEST(PeerCheck, WantsTheWholeApplicationUri) {
    const auto peers = PeerCheck::create(::testing::TempDir() + "peer_check", {}).value();
    UA_CertificateVerification plugin{};
    peers->install(plugin);
    auto der = clientIdentity().certificate.der();
    const auto verdictOn = [&](std::string uri) {
        const UA_ByteString certificate{der.size(), reinterpret_cast<UA_Byte*>(der.data())};
        const UA_String text{uri.size(), reinterpret_cast<UA_Byte*>(uri.data())};
        return StatusCode(plugin.verifyApplicationURI(&plugin, &certificate, &text));
    };
    EXPECT_EQ(verdictOn("urn:test:client"), status::kGood);
    for (const auto* other : {"", "u", "urn:test", "urn:test:client2", "urn:test:Client"}) {
        EXPECT_EQ(verdictOn(other), StatusCode(UA_STATUSCODE_BADCERTIFICATEURIINVALID)) << other;
    }
}

TEST(ServerSecurityOptions, NeedACertificateOfTheServer) {
    ServerOptions options;
    options.application_uri = "urn:test:other";
    options.port = 0;
    options.security =
        ServerSecurity{.credentials = {serverIdentity(), ::testing::TempDir() + "trust"},
                       .authenticate = [](const Login&) { return Result<Admission>({}); }};
    const auto refused = Server::create(options);
    ASSERT_FALSE(refused);
    EXPECT_THAT(refused.error().message, HasSubstr("is of \"urn:test:server\", not of"));
    options.application_uri = kServerUri;
    options.security->authenticate = {};
    EXPECT_FALSE(Server::create(options));
}

}  // namespace
}  // namespace metier::opcua
