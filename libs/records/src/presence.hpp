#pragma once

#include <string>

#include "database.hpp"

namespace metier::records {

/// A server's recorder opens its store for the first time, or again.
enum class Opening { first, again };

/// Tells all others who open the store that the server is there, until the connection ends. The
/// first time, closes what a server of that name has left under way when it died, unless another
/// one is there.
Result<void> attend(Database& database, const std::string& server, Opening opening);

/// Closes what servers have left under way that are there no longer.
/// \param own server that is left out
Result<void> closeLostOfOthers(Database& database, const std::string& own);

}  // namespace metier::records
