#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "metier/base/error.hpp"
#include "metier/opcua/client.hpp"
#include "metier/opcua/security.hpp"
#include "metier/security/security_folder.hpp"

namespace metier::server {

/// Choice of the user how a process and its peers identify themselves.
///
/// Threads: any. All functions read or write files, so they wait for the disk.
struct Security {
    /// Whether connections are used without encryption, certificates and users, on this machine
    /// only: for trials.
    bool insecure_lab = false;
    /// Folder of certificates, keys and users; empty: that of the user, ~/.config/metier.
    std::filesystem::path folder{};

    /// Opens the folder.
    /// Errors: as security::SecurityFolder::open(); resource_unavailable (the user's folder is not
    /// known).
    Result<security::SecurityFolder> openFolder() const;
    /// Reads the certificate of the application with that name from the folder, or makes a new one.
    /// Errors: as openFolder(), security::SecurityFolder::identity().
    Result<opcua::Credentials> credentials(const std::string& name,
                                           const security::IdentityOptions& options) const;

    /// Addresses at which closed servers were met.
    /// Errors: resource_unavailable; those of openFolder().
    Result<security::KnownServers> knownServers() const;
    /// Whether a closed server was met at that address before.
    bool wasClosed(const std::string& url) const;
    /// Notes that a connection with these options was made. If it is secure, a server without
    /// security is refused at that address from now on.
    void noteConnected(const opcua::ClientOptions& options, const std::string& url) const;
    /// Notes that a server of this process serves without security at that address, as its user
    /// decided: clients with the same folder accept that.
    void noteServedOpen(const std::string& url) const;
    /// Checks that an insecure lab may connect to that address.
    /// Errors: access_denied (a closed server was met there before).
    Result<void> checkOpen(const std::string& url) const;
};

/// Makes the connections of a process to servers secure.
class ConnectionSecurity {
public:
    virtual ~ConnectionSecurity() = default;

    /// Adds certificate and user to the options; in an insecure lab, neither.
    /// Errors: access_denied (a lab, and a closed server was met there before; for a command also:
    /// no password, or a server without security); those of Security; for a command, those of
    /// opcua::getEndpoints().
    /// Threads: any; reads files; a command also asks the server for its endpoints.
    virtual Result<void> secure(opcua::ClientOptions& options, const std::string& url) const = 0;
    /// Notes that a connection prepared by secure() was made. Threads: any; writes a file.
    virtual void noteConnected(const opcua::ClientOptions& options,
                               const std::string& url) const = 0;
};

/// Identity of a server towards its clients and towards the servers that it uses: a certificate of
/// its own; in an insecure lab, none.
///
/// Threads: any; it does not change.
class Identity final : public ConnectionSecurity {
public:
    /// \param name name of the application in the security folder
    /// Errors: those of Security::credentials(); none in an insecure lab.
    static Result<Identity> create(Security security, const std::string& name,
                                   const security::IdentityOptions& options);

    /// None in an insecure lab.
    const std::optional<opcua::Credentials>& credentials() const noexcept { return credentials_; }
    /// Choice that it was made with.
    const Security& security() const noexcept { return security_; }

    Result<void> secure(opcua::ClientOptions& options, const std::string& url) const override;
    void noteConnected(const opcua::ClientOptions& options, const std::string& url) const override;

private:
    Identity(Security security, std::optional<opcua::Credentials> credentials);

    Security security_;
    std::optional<opcua::Credentials> credentials_;
};

}  // namespace metier::server
