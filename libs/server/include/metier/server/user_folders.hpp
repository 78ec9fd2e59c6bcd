#pragma once

#include <filesystem>
#include <string>

namespace metier::server {

/// Folder for state of this user's programs that outlives them: $XDG_STATE_HOME/metier, else
/// ~/.local/state/metier; empty if neither variable nor home is known. A relative path in the
/// variable is ignored, as the XDG Base Directory Specification has it.
std::filesystem::path userStateFolder();
/// Folder of this user's settings: $XDG_CONFIG_HOME/metier, else ~/.config/metier, in the same
/// way. It need not exist.
std::filesystem::path userConfigFolder();

/// Host name of this machine; "localhost" if it has none. Threads: any.
std::string hostName();

}  // namespace metier::server
