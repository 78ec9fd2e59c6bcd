#include "churn.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <future>
#include <vector>

#include "metier/security/identity.hpp"
#include "metier/security/trust_store.hpp"
#include "tcp_relay.hpp"

namespace metier::system_tests {
namespace {

using namespace std::chrono_literals;
using std::chrono::steady_clock;

constexpr std::size_t kStrangers = 3;  // processes
constexpr const char* kServerUri = "urn:bench:server";
constexpr const char* kPassword = "secret";

security::Identity identityOf(const std::string& name) {
    return orThrow(
        security::makeIdentity({.application_name = name, .application_uri = "urn:bench:" + name},
                               std::chrono::system_clock::now()));
}

void trustIn(const std::filesystem::path& folder, const security::Identity& peer) {
    orThrow(orThrow(security::TrustStore::open(folder)).trust(peer.certificate));
}

/// A server that trusts the operator's certificate, is trusted by it, and accepts everybody who
/// knows the password.
BenchOptions closed(const std::filesystem::path& folder,
                    const security::Identity& operator_identity) {
    std::filesystem::remove_all(folder);
    const auto server = identityOf("server");
    trustIn(folder / "server", operator_identity);
    trustIn(folder / "client", server);
    const auto authenticate = [](const opcua::Login& login) -> Result<opcua::Admission> {
        return login.password == kPassword ? Result<opcua::Admission>(opcua::Admission{
                                                 login.user, security::Role::operator_})
                                           : fail(Errc::access_denied, "wrong password");
    };
    BenchOptions options;
    options.application_uri = kServerUri;
    options.security = opcua::ServerSecurity{.credentials = {server, folder / "server"},
                                             .authenticate = authenticate};
    return options;
}

AttackCount operator+(const AttackCount& one, const AttackCount& other) {
    return {one.connections + other.connections, one.refused + other.refused, one.cut + other.cut,
            one.requests + other.requests};
}

}  // namespace

Churn::Churn(Cable& cable, std::filesystem::path folder, HaltBounds bounds)
    : cable_(cable),
      bounds_(bounds),
      folder_(std::move(folder)),
      operator_(identityOf("operator")),
      server_(closed(folder_, operator_)) {
    server_.serve();
}

opcua::ClientOptions Churn::clientOf(const security::Identity& identity) const {
    opcua::ClientOptions options;
    options.application_uri = identity.certificate.applicationUri();
    options.security = opcua::Credentials{identity, folder_ / "client"};
    options.user = opcua::UserName{"operator", kPassword};
    options.connect_timeout = 1s;
    return options;
}

/// HEL and OPN of a client whose certificate the server does not know.
std::string Churn::firstWordsOfAStranger() const {
    testing::TcpRelay relay(server_.port());
    if (opcua::Client::connect(relay.url(), clientOf(identityOf("stranger")))) {
        throw std::runtime_error("the server lets a stranger in");
    }
    return relay.sent();
}

Churn::Connecting Churn::connectAgainAndAgain(const std::string& url, SteadyTime end) const {
    Connecting result;
    while (steady_clock::now() < end) {
        const auto begin = steady_clock::now();
        bool connected = false;
        while (!connected && steady_clock::now() < begin + 10s) {
            ++result.attempts;
            connected = opcua::Client::connect(url, clientOf(operator_)).has_value();
        }
        result.took_ms.push_back(
            std::chrono::duration<double, std::milli>(steady_clock::now() - begin).count());
    }
    return result;
}

ChurnOutcome Churn::run(std::chrono::milliseconds time) {
    ChurnOutcome outcome;
    outcome.quiet =
        summaryOf(connectAgainAndAgain(server_.url(), steady_clock::now() + time / 10).took_ms);
    const AttackOrder order{.attack = Attack::half_open,
                            .time = std::chrono::duration_cast<std::chrono::seconds>(time + 60s),
                            .stranger = firstWordsOfAStranger()};
    std::vector<Attacker> strangers;
    for (std::size_t i = 0; i < kStrangers; ++i) {
        strangers.emplace_back(cable_, server_.url(), order);
    }
    load_.takeLongest();
    const auto end = steady_clock::now() + time;
    auto far = std::async(std::launch::async, [&] {
        cable_.enterFarEnd();
        return connectAgainAndAgain(Cable::addressOf(server_.url()), end);
    });
    auto near = connectAgainAndAgain(server_.url(), end);
    auto from_far = far.get();
    const double load_ms = std::chrono::duration<double, std::milli>(load_.takeLongest()).count();
    for (auto& stranger : strangers) {
        outcome.attack = outcome.attack + stranger.end();
    }
    outcome.attempts = near.attempts + from_far.attempts;
    outcome.near = summaryOf(std::move(near.took_ms));
    outcome.far = summaryOf(std::move(from_far.took_ms));
    outcome.defect = judge(outcome, load_ms);
    return outcome;
}

std::string Churn::judge(const ChurnOutcome& outcome, double load_ms) const {
    const double most =
        kConnectMaxMs +
        (bounds_ == HaltBounds::strict ? 0.0 : 4 * outcome.quiet.max_ms + 10 * load_ms);
    for (const auto& connecting : {outcome.near, outcome.far}) {
        if (connecting.count == 0 || connecting.max_ms > most) {
            return fmt::format("an operator connected {} times within {:.0f} ms, over {:.0f} ms",
                               connecting.count, connecting.max_ms, most);
        }
    }
    return {};
}

}  // namespace metier::system_tests
