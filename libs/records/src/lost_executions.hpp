#pragma once

#include <string>

#include "database.hpp"

namespace metier::records {

/// Opening of the store by a server's recorder.
enum class Opening { first, again };

/// Shows all others who open the store that the server is running, as Database::attend() does. The
/// first time, closes the executions that a server of that name left under way when it died, unless
/// another server of that name is running.
Result<Presence> attend(Database& database, const std::string& server, Opening opening);

/// Closes what servers left under way that are there no longer.
/// \param own server that is left out
Result<void> closeLostOfOthers(Database& database, const std::string& own);

}  // namespace metier::records
