#include "closed_bench.hpp"

#include <unistd.h>

#include <chrono>
#include <map>
#include <utility>

#include "metier/security/identity.hpp"
#include "metier/security/trust_store.hpp"

namespace metier::dashboard {

using system_tests::orThrow;

namespace {

/// Made once: it takes some time.
const security::Identity& identityOf(const std::string& uri) {
    static std::map<std::string, security::Identity> made;
    const auto found = made.find(uri);
    return found != made.end()
               ? found->second
               : made.emplace(uri, orThrow(security::makeIdentity(
                                       {.application_name = "test", .application_uri = uri},
                                       std::chrono::system_clock::now())))
                     .first->second;
}

const security::Identity& server() {
    return identityOf("urn:metier:server");
}

const security::Identity& dashboard() {
    return identityOf("urn:metier:dashboard");
}

}  // namespace

ClosedArm::ClosedArm()
    : folder_(std::filesystem::path(::testing::TempDir()) /
              ("closed_arm_" + std::to_string(getpid()))) {
    std::filesystem::remove_all(folder_);
    orThrow(orThrow(security::TrustStore::open(folder_ / "server")).trust(dashboard().certificate));
    orThrow(orThrow(security::TrustStore::open(folder_ / "client")).trust(server().certificate));
    system_tests::BenchOptions options;
    options.limits.sessions_per_application = 100;
    options.security = opcua::ServerSecurity{
        .credentials = {server(), folder_ / "server"},
        .authenticate = [this](const opcua::Login& login) { return admit(login); }};
    arm_.emplace(std::move(options));
    arm_->serve();
}

ClosedArm::~ClosedArm() {
    arm_.reset();
    std::filesystem::remove_all(folder_);
}

opcua::ClientOptions ClosedArm::options() const {
    opcua::ClientOptions options;
    options.application_uri = "urn:metier:dashboard";
    options.security = opcua::Credentials{dashboard(), folder_ / "client"};
    return options;
}

Result<opcua::Admission> ClosedArm::admit(const opcua::Login& login) {
    if (login.user.empty()) {
        return opcua::Admission{"", security::Role::observer};
    }
    ++attempts_;
    if (login.password != "secret" || (login.user != "anna" && login.user != "otto")) {
        return fail(Errc::access_denied, "wrong");
    }
    return opcua::Admission{
        login.user, login.user == "anna" ? security::Role::operator_ : security::Role::observer};
}

}  // namespace metier::dashboard
