#include "host/server_access.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <array>
#include <system_error>
#include <utility>

#include "metier/opcua/text.hpp"

namespace metier::server {
namespace {

using namespace std::chrono_literals;
namespace fs = std::filesystem;

constexpr auto kReadUsersEvery = 2s;
constexpr auto kWarnEvery = 24h;
constexpr std::size_t kMostWaiting = 16;
constexpr std::size_t kMostRemembered = 1'000;

fs::file_time_type latestChange(const security::SecurityFolder& folder) {
    const auto trust = folder.trustFolder();
    const std::array places{trust / "trusted" / "certs", trust / "trusted" / "crl",
                            trust / "issuers" / "certs", trust / "issuers" / "crl",
                            folder.path() / "roles",     folder.usersFile()};
    auto latest = fs::file_time_type::min();
    for (const auto& place : places) {
        std::error_code error;
        const auto time = fs::last_write_time(place, error);
        latest = error ? latest : std::max(latest, time);
    }
    return latest;
}

}  // namespace

Result<std::unique_ptr<ServerAccess>> ServerAccess::open(const Security& security,
                                                         opcua::Credentials own,
                                                         const Clock& clock) {
    METIER_ASSIGN(auto folder, security.openFolder());
    METIER_ASSIGN(auto logins, security::LoginGuard::open(folder.usersFile(), clock));
    METIER_ASSIGN(auto store, security::TrustStore::open(folder.trustFolder()));
    return std::unique_ptr<ServerAccess>(
        new ServerAccess(std::move(own), std::move(folder), std::move(logins), std::move(store)));
}

ServerAccess::ServerAccess(opcua::Credentials own, security::SecurityFolder folder,
                           security::LoginGuard logins, security::TrustStore store)
    : own_(std::move(own)),
      identity_folder_(own_.identity_folder),
      folder_(std::move(folder)),
      logins_(std::move(logins)),
      store_(std::move(store)),
      keeper_([this](const std::stop_token& stop) { keepRefused(stop); }),
      folder_now_(read(), [this](const auto& /*last*/) { return read(); }) {
    seen_ = folder_now_.get()->latest_change;
}

ServerAccess::~ServerAccess() = default;

std::shared_ptr<const ServerAccess::Folder> ServerAccess::read() const {
    return std::make_shared<Folder>(
        Folder{security::loadIdentity(identity_folder_), folder_.roles(), latestChange(folder_)});
}

std::optional<security::Role> ServerAccess::roleOf(const std::string& thumbprint) {
    const auto now = folder_now_.get();
    const auto role = now->roles.find(thumbprint);
    return role == now->roles.end() ? std::nullopt : std::optional(role->second);
}

opcua::ServerSecurity ServerAccess::security() {
    return {.credentials = own_,
            .authenticate = [this](const opcua::Login& login) { return authenticate(login); },
            .on_refused = [this](const opcua::RefusedPeer& peer) { noteRefused(peer); }};
}

void ServerAccess::follow(opcua::Server& server) {
    server.post([this, &server] { look(server); });
}

Result<opcua::Admission> ServerAccess::authenticate(const opcua::Login& login) {
    Result<security::Role> role =
        fail(Errc::access_denied,
             fmt::format("the application {} has no role of its own: log in as a user",
                         login.thumbprint));
    if (!login.user.empty()) {
        role = logins_.check(login.user, login.password, login.thumbprint);
    } else if (const auto own = roleOf(login.thumbprint)) {
        role = *own;
    }
    if (!role) {
        spdlog::warn("{} was not let in: {}",
                     login.user.empty() ? "an application" : opcua::sanitise(login.user),
                     role.error().message);
        return fail(role.error());
    }
    if (let_in_.size() >= kMostRemembered) {
        let_in_.erase(let_in_.begin());
    }
    let_in_[login.thumbprint] = login.certificate;
    return opcua::Admission{login.user, *role};
}

void ServerAccess::noteRefused(const opcua::RefusedPeer& peer) {
    auto certificate = security::Certificate::fromDer(peer.der);
    if (!certificate || peer.refusal.kind != security::RefusalKind::untrusted) {
        return;
    }
    {
        const std::lock_guard lock(mutex_);
        if (refused_.size() >= kMostWaiting) {
            return;
        }
        refused_.push_back(std::move(*certificate));
    }
    wake_.notify_one();
}

/// A disk may be slow, the server's thread must not be.
void ServerAccess::keepRefused(const std::stop_token& stop) {
    std::unique_lock lock(mutex_);
    while (wake_.wait(lock, stop, [this] { return !refused_.empty(); })) {
        const auto certificate = std::move(refused_.front());
        refused_.pop_front();
        lock.unlock();
        if (auto store = security::TrustStore::open(folder_.trustFolder())) {
            store->keepRejected(certificate);
        }
        lock.lock();
    }
}

void ServerAccess::look(opcua::Server& server) {
    const auto folder = folder_now_.get();
    takeRenewed(server, folder->identity);
    warnOfEnd();
    if (folder->latest_change != seen_) {
        seen_ = folder->latest_change;
        closeStrangers(server);
    }
    timer_ = server.after(kReadUsersEvery, [this, &server] { look(server); });
}

void ServerAccess::takeRenewed(opcua::Server& server, const Result<security::Identity>& present) {
    if (!present) {
        if (unread_ != present.error().message) {
            unread_ = present.error().message;
            spdlog::error("the server keeps its certificate: {}", unread_);
        }
        return;
    }
    unread_.clear();
    if (present->certificate == own_.identity.certificate) {
        return;
    }
    own_.identity = *present;
    warned_ = {};
    if (const auto renewed = server.renewIdentity(*present); !renewed) {
        spdlog::error("the renewed certificate is not used: {}", renewed.error().message);
    }
}

void ServerAccess::warnOfEnd() {
    const auto now = std::chrono::steady_clock::now();
    if (warned_ != SteadyTime{} && now - warned_ < kWarnEvery) {
        return;
    }
    warned_ = now;
    const auto end = own_.identity.certificate.notAfter();
    if (std::chrono::system_clock::now() + security::kRenewalTime > end) {
        spdlog::warn("the certificate of this server ends on {}: metier trust renew {}",
                     security::dateText(end), own_.identity_folder.filename().string());
    }
}

/// A session stays when its certificate ends, or a clock says so: nothing that moves may stop by
/// it.
bool ServerAccess::isTrustedStill(const std::string& thumbprint) {
    const auto let_in = let_in_.find(thumbprint);
    if (let_in == let_in_.end()) {
        return false;
    }
    const auto certificate = security::Certificate::fromDer(let_in->second);
    if (!certificate) {
        return false;
    }
    const auto within = std::clamp(std::chrono::system_clock::now(), certificate->notBefore(),
                                   certificate->notAfter());
    return store_.check(let_in->second, within).has_value();
}

std::optional<security::Role> ServerAccess::roleNow(const std::string& user,
                                                    const std::string& thumbprint) {
    if (!isTrustedStill(thumbprint)) {
        return std::nullopt;
    }
    return user.empty() ? roleOf(thumbprint) : logins_.roleOf(user);
}

void ServerAccess::closeStrangers(opcua::Server& server) {
    server.closeSessions([this](const opcua::Session& session) {
        const bool stays = roleNow(session.user, session.thumbprint) == session.role;
        if (!stays) {
            spdlog::warn("the session of {} with the certificate {} is closed: its rights changed",
                         session.user.empty() ? "an application" : session.user,
                         session.thumbprint);
        }
        return !stays;
    });
}

Result<std::unique_ptr<ServerAccess>> secureServer(opcua::ServerOptions& options,
                                                   const Identity& identity, const Clock& clock) {
    if (!identity.credentials()) {
        return std::unique_ptr<ServerAccess>();
    }
    options.application_uri = identity.credentials()->identity.certificate.applicationUri();
    auto access = ServerAccess::open(identity.security(), *identity.credentials(), clock);
    if (access) {
        options.security = (*access)->security();
    }
    return access;
}

}  // namespace metier::server
