#include "closed_server.hpp"

#include <chrono>

#include "metier/security/trust_store.hpp"

namespace metier::hostile {

using system_tests::orThrow;

namespace {

security::Identity makeIdentity(const std::filesystem::path& folder, const std::string& uri) {
    const auto identity = orThrow(security::makeIdentity(
        {.application_name = "hostile", .application_uri = uri}, std::chrono::system_clock::now()));
    orThrow(security::saveIdentity(folder, identity));
    return identity;
}

void trustIn(const std::filesystem::path& folder, const security::Identity& peer) {
    orThrow(orThrow(security::TrustStore::open(folder)).trust(peer.certificate));
}

}  // namespace

void makeIdentities(const std::filesystem::path& folder) {
    const auto server = makeIdentity(folder / "server", kServerUri);
    const auto client = makeIdentity(folder / "client", "urn:metier:watcher");
    trustIn(folder / "server" / "trust", client);
    trustIn(folder / "client" / "trust", server);
}

opcua::ServerSecurity securityIn(const std::filesystem::path& folder) {
    return {.credentials = {orThrow(security::loadIdentity(folder / "server")),
                            folder / "server" / "trust"},
            .authenticate = [](const opcua::Login& login) -> Result<opcua::Admission> {
                if (login.user != kOperator || login.password != kPassword) {
                    return fail(Errc::access_denied, "wrong");
                }
                return opcua::Admission{login.user, security::Role::operator_};
            }};
}

opcua::ClientOptions clientOptionsIn(const std::filesystem::path& folder) {
    opcua::ClientOptions options;
    options.security = opcua::Credentials{orThrow(security::loadIdentity(folder / "client")),
                                          folder / "client" / "trust"};
    options.user = opcua::UserName{kOperator, kPassword};
    return options;
}

}  // namespace metier::hostile
