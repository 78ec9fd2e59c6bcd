#include "metier/server/identity.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <chrono>
#include <utility>

#include "metier/server/user_folders.hpp"

namespace metier::server {
namespace {

Result<std::filesystem::path> folderOf(const Security& security) {
    auto folder = security.folder.empty() ? userConfigFolder() : security.folder;
    return folder.empty() ? fail(Errc::resource_unavailable,
                                 "neither HOME nor XDG_CONFIG_HOME says where certificates are "
                                 "kept: name a folder with --security")
                          : Result<std::filesystem::path>(std::move(folder));
}

}  // namespace

Result<security::SecurityFolder> Security::openFolder() const {
    const auto place = folderOf(*this);
    return place ? security::SecurityFolder::open(*place) : fail(place.error());
}

Result<opcua::Credentials> Security::credentials(const std::string& name,
                                                 const security::IdentityOptions& options) const {
    METIER_ASSIGN(auto place, openFolder());
    METIER_ASSIGN(auto identity, place.identity(name, options, std::chrono::system_clock::now()));
    return opcua::Credentials{std::move(identity), place.trustFolder(), place.identityFolder(name)};
}

Result<security::KnownServers> Security::knownServers() const {
    const auto place = folderOf(*this);
    return place ? Result<security::KnownServers>(security::SecurityFolder::knownServers(*place))
                 : fail(place.error());
}

bool Security::wasClosed(const std::string& url) const {
    const auto known = knownServers();
    return known && known->isClosed(url);
}

void Security::noteConnected(const opcua::ClientOptions& options, const std::string& url) const {
    const auto known = options.security ? knownServers() : fail(Errc::not_found, "");
    if (!known) {
        return;
    }
    if (const auto noted = known->noteClosed(url); !noted) {
        spdlog::warn("{} is not remembered as closed: {}", url, noted.error().message);
    }
}

void Security::noteServedOpen(const std::string& url) const {
    const auto known = knownServers();
    const auto forgotten = known ? known->forget(url) : fail(known.error());
    if (!forgotten) {
        spdlog::debug("{}: {}", url, forgotten.error().message);
    }
}

Result<void> Security::checkOpen(const std::string& url) const {
    return wasClosed(url)
               ? fail(Errc::access_denied,
                      fmt::format("this server was closed before, and is not spoken to without "
                                  "security: leave out --insecure-lab. If it was made a lab: "
                                  "metier trust forget {}",
                                  url))
               : Result<void>();
}

Result<Identity> Identity::create(Security security, const std::string& name,
                                  const security::IdentityOptions& options) {
    if (security.insecure_lab) {
        return Identity(std::move(security), std::nullopt);
    }
    METIER_ASSIGN(auto credentials, security.credentials(name, options));
    return Identity(std::move(security), std::move(credentials));
}

Identity::Identity(Security security, std::optional<opcua::Credentials> credentials)
    : security_(std::move(security)), credentials_(std::move(credentials)) {}

Result<void> Identity::secure(opcua::ClientOptions& options, const std::string& url) const {
    if (!credentials_) {
        return security_.checkOpen(url);
    }
    options.security = credentials_;
    return {};
}

void Identity::noteConnected(const opcua::ClientOptions& options, const std::string& url) const {
    security_.noteConnected(options, url);
}

}  // namespace metier::server
