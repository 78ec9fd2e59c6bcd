#pragma once

#include <string>
#include <vector>

#include "commands.hpp"
#include "metier/base/error.hpp"
#include "metier/opcua/search.hpp"

namespace metier::app {

/// The servers that a command speaks to: addresses, those of a cell file, or those that it finds.
struct ServerChoice {
    std::vector<std::string> urls{};
    std::string cell{};
    std::vector<std::string> discovery{};
};

/// Adds the arguments for addresses and a cell file to a command.
void addServerChoice(CLI::App& command, ServerChoice& choice);
/// Adds the options of a command that finds its servers by itself if no address is given.
void addServerSearch(CLI::App& command, ServerChoice& choice);

/// Asks discovery servers; without any given: the one of this machine, and mDNS.
opcua::Sighting searchFor(std::vector<std::string> discovery);

/// The chosen servers. Without a choice those of the file cell.toml in the current folder, or else
/// those that searchFor() finds, which are printed to standard error.
/// Errors: invalid_argument for a wrong cell file; not_found if there is no server at all.
Result<std::vector<opcua::FoundServer>> serversOf(const ServerChoice& choice);
/// The addresses of serversOf(). Errors: those of serversOf().
Result<std::vector<std::string>> addressesOf(const ServerChoice& choice);

}  // namespace metier::app
