#pragma once

#include <string>
#include <vector>

#include "command_context.hpp"

namespace metier::app {

/// Adds the options on security, which every command has.
void addSecurityOptions(CLI::App& app, CommandContext& context);
/// The same options for another `metier` that this one starts.
std::vector<std::string> securityArguments(const server::Security& security);

/// Notice on standard error of a command that starts or shows servers without security; nothing
/// unless this is an insecure lab.
void printLabNotice(const server::Security& security);
/// Warns in the log that a server has no security; nothing unless this is an insecure lab.
void warnOfLab(const server::Security& security, const std::string& server, const std::string& url);

}  // namespace metier::app
