#pragma once

#include <condition_variable>
#include <deque>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

#include "metier/base/background_read.hpp"
#include "metier/base/clock.hpp"
#include "metier/base/error.hpp"
#include "metier/opcua/security.hpp"
#include "metier/opcua/server.hpp"
#include "metier/security/login_guard.hpp"
#include "metier/security/security_folder.hpp"
#include "metier/server/identity.hpp"

namespace metier::server {

/// Decides which clients a closed server accepts, by the security folder.
///
/// Users log in by name and password; an application without a user gets the role it has in the
/// folder, if any. Changes in the folder take effect within seconds: sessions are closed if their
/// application is not trusted any more, or if their user was removed or has another role; the
/// server uses a renewed certificate, and warns before its own expires.
/// Threading: between open() and the end of the server, the server's thread, which does not wait
/// for a disk; threads of its own read and write files.
class ServerAccess {
public:
    /// \param own of `security`
    /// \param clock must outlive this
    /// Errors: as Security::openFolder(), security::LoginGuard::open().
    static Result<std::unique_ptr<ServerAccess>> open(const Security& security,
                                                      opcua::Credentials own, const Clock& clock);
    ~ServerAccess();
    ServerAccess(const ServerAccess&) = delete;
    ServerAccess& operator=(const ServerAccess&) = delete;

    /// For the options of the server, which this must outlive.
    opcua::ServerSecurity security();
    /// Has the server follow the folder. Once, before Server::start().
    void follow(opcua::Server& server);

private:
    ServerAccess(opcua::Credentials own, security::SecurityFolder folder,
                 security::LoginGuard logins, security::TrustStore store);
    Result<opcua::Admission> authenticate(const opcua::Login& login);
    bool isTrustedStill(const std::string& thumbprint);
    std::optional<security::Role> roleNow(const std::string& user, const std::string& thumbprint);
    void noteRefused(const opcua::RefusedPeer& peer);
    void look(opcua::Server& server);
    void takeRenewed(opcua::Server& server, const Result<security::Identity>& present);
    void warnOfEnd();
    void closeStrangers(opcua::Server& server);
    void keepRefused(const std::stop_token& stop);

    /// Contents of the security folder besides users and trusted certificates.
    struct Folder {
        Result<security::Identity> identity;
        std::map<std::string, security::Role> roles;      ///< key: thumbprint
        std::filesystem::file_time_type latest_change{};  ///< of the files that decide on rights
    };
    std::shared_ptr<const Folder> read() const;
    std::optional<security::Role> roleOf(const std::string& thumbprint);

    opcua::Credentials own_;
    const std::filesystem::path identity_folder_;
    const security::SecurityFolder folder_;
    security::LoginGuard logins_;
    security::TrustStore store_;
    std::map<std::string, std::string> let_in_;  // DER of applications by thumbprint
    std::filesystem::file_time_type seen_{};     // the latest change of the folder
    std::string unread_;  // why the folder's certificate could not be read; empty: it could
    SteadyTime warned_{};
    opcua::TimerHandle timer_;

    std::mutex mutex_;  // guards all that follows
    std::condition_variable_any wake_;
    std::deque<security::Certificate> refused_;
    std::jthread keeper_;
    BackgroundRead<Folder> folder_now_;  // last: its thread uses both folders
};

/// Makes a server with these options closed, under the ApplicationUri of its certificate; in an
/// insecure lab it stays open, under the one that the options have, and the result is null.
/// Errors: as ServerAccess::open().
Result<std::unique_ptr<ServerAccess>> secureServer(opcua::ServerOptions& options,
                                                   const Identity& identity, const Clock& clock);

}  // namespace metier::server
