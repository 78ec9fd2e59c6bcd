#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "metier/base/error.hpp"
#include "metier/opcua/client.hpp"
#include "metier/opcua/security.hpp"
#include "metier/security/security_folder.hpp"

namespace metier::server {

/// How a process and those that it speaks to know each other, as the user of the process chose.
///
/// Threads: any. All functions read or write files.
struct Security {
    /// All connections without encryption, certificates and users, on this machine alone: for
    /// trials.
    bool insecure_lab = false;
    /// Folder of certificates, keys and users; empty: that of the user, ~/.config/metier.
    std::filesystem::path folder{};

    /// Errors: as security::SecurityFolder::open(); resource_unavailable (nobody says where it is).
    Result<security::SecurityFolder> openFolder() const;
    /// The application of that name in the folder, which is made if it is not there.
    /// Errors: as openFolder(), security::SecurityFolder::identity().
    Result<opcua::Credentials> credentials(const std::string& name,
                                           const security::IdentityOptions& options) const;

    /// Addresses at which servers were closed. Errors: resource_unavailable, as openFolder().
    Result<security::KnownServers> knownServers() const;
    /// Whether a server at that address was closed before.
    bool wasClosed(const std::string& url) const;
    /// A connection with these options was made: if it is secure, no open server is believed at
    /// that address from now on.
    void noteConnected(const opcua::ClientOptions& options, const std::string& url) const;
    /// A server of this process serves at that address without security: its user decided so, and
    /// clients of the same folder need not wonder.
    void noteServedOpen(const std::string& url) const;
    /// Errors: access_denied (a server was closed before at the address that an insecure lab is to
    ///         speak to).
    Result<void> checkOpen(const std::string& url) const;
};

/// Makes the connections of a process to servers secure.
class ConnectionSecurity {
public:
    virtual ~ConnectionSecurity() = default;

    /// Adds certificate and user to the options; neither in an insecure lab.
    /// Errors: access_denied (a lab, and the server there was closed before; for a command also: no
    ///         password, or a server without security); those of Security; for a command, as
    ///         opcua::getEndpoints().
    /// Threads: any; reads files, and a command asks the server for its endpoints.
    virtual Result<void> secure(opcua::ClientOptions& options, const std::string& url) const = 0;
    /// A connection that secure() prepared was made. Threads: any; writes a file.
    virtual void noteConnected(const opcua::ClientOptions& options,
                               const std::string& url) const = 0;
};

/// Name of a server to its clients and to the servers that it uses: a certificate of its own; in an
/// insecure lab, none.
///
/// Threads: any; it does not change.
class Identity final : public ConnectionSecurity {
public:
    /// \param name of the application in the security folder
    /// Errors: those of Security::credentials(); none in an insecure lab.
    static Result<Identity> create(Security security, const std::string& name,
                                   const security::IdentityOptions& options);

    /// None in an insecure lab.
    const std::optional<opcua::Credentials>& credentials() const noexcept { return credentials_; }
    const Security& security() const noexcept { return security_; }

    Result<void> secure(opcua::ClientOptions& options, const std::string& url) const override;
    void noteConnected(const opcua::ClientOptions& options, const std::string& url) const override;

private:
    Identity(Security security, std::optional<opcua::Credentials> credentials);

    Security security_;
    std::optional<opcua::Credentials> credentials_;
};

}  // namespace metier::server
