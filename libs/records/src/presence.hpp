#pragma once

#include <string>

#include "database.hpp"
#include "metier/records/recorder.hpp"

namespace metier::records {

/// A server's recorder opens its store for the first time, or again.
enum class Opening { first, again };

struct Attended {
    Presence presence{};
    Dropped lost{};  ///< what it could not make rows of
};

/// Tells all others who open the store that the server is there, as Database::attend() does. The
/// first time, makes rows of what a server of that name has left when it died and closes what was
/// under way, unless another one is there.
Result<Attended> attend(Database& database, const std::string& server, Opening opening,
                        Recorder::ToJson to_json);

/// The same for servers that are there no longer.
/// \param own server that is left out
/// \return what it could not make rows of
Result<Dropped> closeLostOfOthers(Database& database, const std::string& own,
                                  Recorder::ToJson to_json);

}  // namespace metier::records
