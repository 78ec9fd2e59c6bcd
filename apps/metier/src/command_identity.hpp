#pragma once

#include <mutex>
#include <optional>
#include <string>

#include "metier/server/identity.hpp"

namespace metier::app {

/// Reads the password from the environment variable METIER_PASSWORD, else from the terminal,
/// without showing it.
/// Errors: access_denied, if there is neither.
Result<std::string> readPassword(const std::string& user);

/// Name of a command to the servers that it speaks to: a certificate that all commands share, and a
/// user if one is named. Both are made, and the password asked for, when the first closed server
/// needs them.
///
/// Threads: any, once the command line is read.
class CommandIdentity final : public server::ConnectionSecurity {
public:
    /// \param security, user of the command line; both must outlive this
    CommandIdentity(const server::Security& security, const std::string& user);

    Result<void> secure(opcua::ClientOptions& options, const std::string& url) const override;
    void noteConnected(const opcua::ClientOptions& options, const std::string& url) const override;
    /// Remedy for a connection that was refused; empty if none is known.
    std::string adviceOn(const opcua::Failure& refusal) const;

private:
    Result<void> prepare() const;

    const server::Security& security_;
    const std::string& user_;
    mutable std::mutex mutex_;  // guards all that follows
    mutable std::optional<opcua::Credentials> credentials_;
    mutable std::optional<opcua::UserName> login_;
};

}  // namespace metier::app
