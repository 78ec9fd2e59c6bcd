// Servers that are closed: who is let in, by which connection, and who is not.
#include "metier/opcua/security.hpp"

#include <gmock/gmock.h>

#include <filesystem>
#include <mutex>

#include "metier/opcua/client.hpp"
#include "metier/opcua/discovery.hpp"
#include "metier/opcua/server.hpp"
#include "peer_check.hpp"

namespace metier::opcua {
namespace {

using ::testing::HasSubstr;

constexpr const char* kServerUri = "urn:test:server";

trust::Identity identityOf(const std::string& name) {
    return trust::makeIdentity({.application_name = name, .application_uri = "urn:test:" + name},
                               std::chrono::system_clock::now())
        .value();
}

/// Two identities for all tests: to make a key takes a while.
const trust::Identity& serverIdentity() {
    static const auto identity = identityOf("server");
    return identity;
}
const trust::Identity& clientIdentity() {
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
    void trustIn(const std::string& who, const trust::Identity& peer) {
        ASSERT_TRUE(trust::TrustStore::open(folder_ / who).value().trust(peer.certificate));
    }
    void start() {
        ServerOptions options;
        options.application_uri = kServerUri;
        options.port = 0;
        options.security = ServerSecurity{.credentials = {serverIdentity(), folder_ / "server"},
                                          .authenticate =
                                              [](const Login& login) {
                                                  return login.user == "operator" &&
                                                                 login.password == "secret" &&
                                                                 !login.thumbprint.empty()
                                                             ? Result<void>()
                                                             : fail(Errc::access_denied, "wrong");
                                              },
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

    ClientOptions options(const trust::Identity& identity = clientIdentity()) const {
        ClientOptions options;
        options.security = Credentials{identity, folder_ / "client"};
        options.user = UserName{"operator", "secret"};
        return options;
    }
    Answer<std::unique_ptr<Client>> connect(const ClientOptions& options) const {
        return Client::connect(server_->endpointUrl(), options);
    }
    trust::RefusalKind lastRefusal() {
        const std::lock_guard lock(mutex_);
        return refused_.back().kind;
    }

    const std::filesystem::path folder_ = emptyFolder();
    std::mutex mutex_;
    std::vector<trust::CertificateRefusal> refused_;
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
    const auto added = server_->call([&] {
        return server_->nodes().addMethod(
            {.node = {who, ids::kObjectsFolder, ids::kHasComponent, {1, "who"}},
             .inputs = {},
             .outputs = {},
             .handler = [&](const CallContext& context,
                            std::span<const Value>) -> Result<std::vector<Value>> {
                 seen = context.session;
                 return std::vector<Value>();
             }});
    });
    ASSERT_TRUE(added) << added.error().message;
    const auto client = connect(options());
    ASSERT_TRUE(client) << client.error().message;
    ASSERT_TRUE((*client)->call(ids::kObjectsFolder, who));
    EXPECT_EQ(seen.user, "operator");
    EXPECT_EQ(seen.thumbprint, clientIdentity().certificate.thumbprint());
    EXPECT_EQ(seen.application_uri, "urn:test:client");
}

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

TEST_F(ClosedServer, RefusesAStrangerAndTellsOfIt) {
    const auto stranger = identityOf("stranger");
    EXPECT_FALSE(connect(options(stranger)));
    EXPECT_EQ(lastRefusal(), trust::RefusalKind::untrusted);
}

TEST_F(ClosedServer, TakesAStrangerOnceHeIsTrusted) {
    const auto stranger = identityOf("stranger");
    EXPECT_FALSE(connect(options(stranger)));
    trustIn("server", stranger);
    const auto client = connect(options(stranger));
    EXPECT_TRUE(client) << client.error().message;
}

TEST_F(ClosedServer, IsNotTrustedByAClientThatDoesNotKnowIt) {
    ASSERT_TRUE(trust::TrustStore::open(folder_ / "client")
                    .value()
                    .distrust(serverIdentity().certificate.thumbprint()));
    const auto refused = connect(options());
    ASSERT_FALSE(refused);
    EXPECT_THAT(refused.error().message,
                HasSubstr(serverIdentity().certificate.thumbprint() + ") is not trusted"));
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
                       .authenticate = [](const Login&) { return Result<void>(); },
                       .on_refused = {}};
    const auto refused = Server::create(options);
    ASSERT_FALSE(refused);
    EXPECT_THAT(refused.error().message, HasSubstr("is of \"urn:test:server\", not of"));
    options.application_uri = kServerUri;
    options.security->authenticate = {};
    EXPECT_FALSE(Server::create(options));
}

}  // namespace
}  // namespace metier::opcua
