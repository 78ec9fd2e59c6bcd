#include "audited_server.hpp"

#include "bare_client.hpp"

namespace metier::opcua::testing {

namespace {

/// Below an Arm: Start(Parameters: BaseDataType), refused if that is Null; Beat(); Tell().
void addMethods(Server& server) {
    auto& nodes = server.nodes();
    ASSERT_TRUE(
        nodes.addObject({.node = {kArm, ids::kObjectsFolder, ids::kOrganizes, {2, "Arm"}}}));
    const auto add = [&](const NodeId& id, const char* name, std::vector<Argument> inputs,
                         MethodEffect effect) {
        const auto handler = [](const CallContext&,
                                std::span<const Value> given) -> Result<std::vector<Value>> {
            if (!given.empty() && given[0] == Value::of("refuse")) {
                return fail(Errc::locked, "held by \x1b[31msomebody");
            }
            return std::vector<Value>();
        };
        ASSERT_TRUE(nodes.addMethod({.node = {id, kArm, ids::kHasComponent, {2, name}},
                                     .inputs = std::move(inputs),
                                     .outputs = {},
                                     .handler = handler}));
        ASSERT_TRUE(nodes.setMethod(id, handler, effect));
    };
    add(kStart, "Start", {{"What", ids::kBaseDataType, -3, {}, {}}}, MethodEffect::commands);
    add(kBeat, "Beat", {}, MethodEffect::renews);
    add(kTell, "Tell", {}, MethodEffect::tells);
}

const security::Identity& serverIdentity() {
    static const auto identity =
        security::makeIdentity({.application_name = "server", .application_uri = "urn:test:server"},
                               std::chrono::system_clock::now())
            .value();
    return identity;
}

std::filesystem::path emptyFolder() {
    const auto* name = ::testing::UnitTest::GetInstance()->current_test_info()->name();
    auto folder = std::filesystem::path(::testing::TempDir()) / "audit_test" / name;
    std::filesystem::remove_all(folder);
    return folder;
}

Result<Admission> admit(const Login& login) {
    if (login.password != "secret") {
        return fail(Errc::access_denied, "wrong password");
    }
    for (const auto role : {security::Role::observer, security::Role::operator_,
                            security::Role::engineer, security::Role::security_admin}) {
        if (login.user == security::toString(role)) {
            return Admission{login.user, role};
        }
    }
    return fail(Errc::access_denied, "unknown user");
}

}  // namespace

security::Identity AuditedServer::identityOf(const std::string& name) {
    return security::makeIdentity({.application_name = name, .application_uri = "urn:test:" + name},
                                  std::chrono::system_clock::now())
        .value();
}

const security::Identity& AuditedServer::clientIdentity() {
    static const auto identity = identityOf("client");
    return identity;
}

void AuditedServer::serve(std::optional<ServerSecurity> security) {
    auto options = testOptions();
    options.application_uri = kServerUri;
    options.security = std::move(security);
    options.on_audit = records_.hook();
    server_ = makeServer(options);
    addMethods(*server_);
    ASSERT_TRUE(server_->start());
}

void AuditedServer::serveClosed() {
    folder_ = emptyFolder();
    trustIn("server", clientIdentity());
    trustIn("client", serverIdentity());
    serve(ServerSecurity{.credentials = {serverIdentity(), folder_ / "server"},
                         .authenticate = admit});
}

void AuditedServer::trustIn(const std::string& who, const security::Identity& peer) {
    ASSERT_TRUE(security::TrustStore::open(folder_ / who).value().trust(peer.certificate));
}

Answer<std::unique_ptr<Client>> AuditedServer::connect(const std::string& user,
                                                       const std::string& password,
                                                       const security::Identity& identity) {
    ClientOptions options;
    options.security = Credentials{identity, folder_ / "client"};
    options.user = UserName{user, password};
    return Client::connect(server_->endpointUrl(), options);
}

std::unique_ptr<Client> AuditedServer::connected(const std::string& user) {
    auto client = connect(user);
    EXPECT_TRUE(client) << client.error().message;
    return std::move(*client);
}

}  // namespace metier::opcua::testing
