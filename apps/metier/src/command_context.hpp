#pragma once

#include <string>

#include "command_identity.hpp"
#include "commands.hpp"

namespace metier::app {

/// State that commands share which speak to servers. Main makes it, and the command line fills it
/// before a command runs.
struct CommandContext {
    server::Security security;
    std::string user;  ///< log in as this one; empty: as the application
    CommandIdentity identity{security, user};
    Exit exit = Exit::success;  ///< exit status of the command
};

}  // namespace metier::app
