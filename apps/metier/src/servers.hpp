#pragma once

#include <memory>
#include <string>
#include <vector>

#include "commands.hpp"
#include "metier/base/error.hpp"
#include "metier/opcua/client.hpp"

namespace metier::app {

/// The servers a command talks to: addresses, or those of a cell file.
struct ServerChoice {
    std::vector<std::string> urls;
    std::string cell;
};

/// Adds the arguments for it to a command.
void addServerChoice(CLI::App& command, ServerChoice& choice);

/// Errors: invalid_argument if neither addresses nor a cell are given, or the cell is wrong.
Result<std::vector<std::string>> addressesOf(const ServerChoice& choice);

/// Connects within 5 s. The error names the address.
Result<std::unique_ptr<opcua::Client>> connectTo(const std::string& url);

}  // namespace metier::app
