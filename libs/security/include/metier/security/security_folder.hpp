#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "metier/base/clock.hpp"
#include "metier/base/error.hpp"
#include "metier/security/certificate.hpp"
#include "metier/security/identity.hpp"
#include "metier/security/known_servers.hpp"
#include "metier/security/trust_store.hpp"
#include "metier/security/users.hpp"

namespace metier::security {

/// All that the applications of one user of a machine need for security, in a folder that nobody
/// else may write:
///   own/NAME/identity.pem  identity of each application
///   trust/                 certificates that they trust, a TrustStore
///   roles/THUMBPRINT       role of an application that logs in without a user
///   users                  users that may log in, a UserTable
///   closed/                addresses where servers proved their identity, KnownServers
/// Applications whose identity is made here trust each other and may act as Operator: a person who
/// can write to this folder could grant that anyway.
/// Threading: any thread, one at a time; several processes may use one folder.
class SecurityFolder {
public:
    /// Opens the folder and makes missing parts, with access for the owner only.
    /// Errors: resource_unavailable; access_denied (others may write to the folder).
    static Result<SecurityFolder> open(std::filesystem::path folder);

    /// Identity of that name; makes a new one if there is none.
    /// \param name letters, digits, `.`, `-` and `_`
    /// Errors: invalid_argument (the name, an option), resource_unavailable, access_denied.
    Result<Identity> identity(const std::string& name, const IdentityOptions& options, UtcTime now);
    /// Gives an application a new key and certificate. The new certificate is trusted like the
    /// former one, which stays trusted.
    /// Errors: not_found; as identity().
    Result<Identity> renew(const std::string& name, UtcTime now);

    /// An identity in this folder.
    struct Own {
        /// Name of the application, as identity() takes it.
        std::string name;
        /// Its certificate.
        Certificate certificate;
    };
    /// Identities in this folder that can be read, sorted by name.
    std::vector<Own> own() const;

    /// Role of the application with that thumbprint; nothing: the application needs a user.
    std::optional<Role> roleOf(std::string_view thumbprint) const;
    /// Roles of all applications that have a role, by thumbprint.
    std::map<std::string, Role> roles() const;
    /// Sets the role of an application; nothing: it needs a user from now on.
    /// Errors: resource_unavailable.
    Result<void> setRole(const Certificate& certificate, std::optional<Role> role);

    /// The folder itself.
    const std::filesystem::path& path() const noexcept { return folder_; }
    /// Path of an application's identity in this folder; it need not exist, nor need those below.
    std::filesystem::path identityFolder(const std::string& name) const;
    /// Path of the TrustStore.
    std::filesystem::path trustFolder() const { return folder_ / "trust"; }
    /// Path of the UserTable.
    std::filesystem::path usersFile() const { return folder_ / "users"; }
    /// Addresses of closed servers, for a client that needs nothing else of the folder.
    /// \param folder a security folder, which need not exist
    static KnownServers knownServers(const std::filesystem::path& folder) {
        return KnownServers(folder / "closed");
    }

private:
    explicit SecurityFolder(std::filesystem::path folder) : folder_(std::move(folder)) {}
    Result<Identity> keep(const std::string& name, Identity identity);

    std::filesystem::path folder_;
};

/// A certificate that expires within this time should be renewed.
constexpr std::chrono::days kRenewalTime{30};

}  // namespace metier::security
