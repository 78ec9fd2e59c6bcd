#pragma once

#include <filesystem>
#include <string>

#include "metier/cell/cell.hpp"

namespace metier::server {

/// Choice of the user where a server keeps data that outlives it.
struct StateChoice {
    /// Folder for names of executions and the audit log; empty: userStateFolder(), but none for a
    /// server on any free port, which is another server at each start.
    std::filesystem::path folder{};
    /// Place of the records, as cell::Records::url; empty: that of the configuration, else
    /// records.db in the folder.
    std::string records{};
};

/// Sets the state folder and the place of the records of a server. The user's folder is made if it
/// is missing; if that fails, a warning is logged and the server keeps no state.
/// \param config with its final port
/// Threads: any; waits for the disk.
void chooseState(cell::ServerConfig& config, const StateChoice& choice);

}  // namespace metier::server
