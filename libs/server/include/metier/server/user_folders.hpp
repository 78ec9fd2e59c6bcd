#pragma once

#include <filesystem>
#include <string>

namespace metier::server {

/// Where this user's programs keep what outlives them: $XDG_STATE_HOME/metier, else
/// ~/.local/state/metier; empty if nobody says where that is.
std::filesystem::path userStateFolder();
/// Where this user's settings are: $XDG_CONFIG_HOME/metier, else ~/.config/metier; may be empty.
std::filesystem::path userConfigFolder();

/// Name of this machine, as it calls itself; "localhost" if it does not. Threads: any.
std::string hostName();

}  // namespace metier::server
