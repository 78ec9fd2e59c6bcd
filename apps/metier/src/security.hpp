#pragma once

#include <optional>
#include <string>
#include <vector>

#include "commands.hpp"
#include "metier/base/error.hpp"
#include "metier/opcua/client.hpp"
#include "metier/opcua/security.hpp"
#include "metier/security/security_folder.hpp"

// Who this process is to those that it connects to, and they to it: one for the whole process,
// as the command line says. Threads: any, once the command line is read.

namespace metier::app {

/// Adds the options on security, which every command has.
void addSecurityOptions(CLI::App& app);
/// The same options for another `metier` that this one starts.
std::vector<std::string> securityArguments();

/// Whether all connections are without security, to loopback addresses alone.
bool isInsecureLab();
/// To be told to people by whatever starts such servers.
constexpr const char* kInsecureLab =
    "INSECURE LAB: no encryption, and everybody on this machine may command";

/// That of `--security`, else of the user.
/// Errors: as security::SecurityFolder::open(); resource_unavailable (nobody says where it is).
Result<security::SecurityFolder> openSecurityFolder();

/// From now on this process is that application, not a command. Nothing happens in an insecure lab.
/// Errors: as security::SecurityFolder::identity().
Result<void> becomeApplication(const std::string& name, const security::IdentityOptions& options);
/// Of what becomeApplication() made this process; none before, and in an insecure lab.
std::optional<opcua::Credentials> ownCredentials();

/// Makes a connection to that server secure: by the own certificate, as the user of `--user`. In an
/// insecure lab it is without security, and without a user.
/// Errors: openSecurityFolder(); access_denied (no password; an open server, and this is no lab; a
///         lab, and the server there was closed before); for a command, as getEndpoints().
Result<void> secure(opcua::ClientOptions& options, const std::string& url);
/// A connection that secure() prepared was made: if it is secure, no open server is believed at
/// that address from now on. Waits for the disk.
void noteConnected(const opcua::ClientOptions& options, const std::string& url);
/// A server of this process serves at that address without security: its user decided so, and
/// clients of the same folder need not wonder.
void noteServedOpen(const std::string& url);
/// Addresses at which servers were closed. Errors: resource_unavailable, as openSecurityFolder().
Result<security::KnownServers> knownServers();

/// What is to be done about a connection that was refused; empty if that is not known.
std::string adviceOn(const opcua::Failure& refusal);

/// From the environment variable METIER_PASSWORD, else from the terminal, without showing it.
/// Errors: access_denied, if there is neither.
Result<std::string> readPassword(const std::string& user);

}  // namespace metier::app
