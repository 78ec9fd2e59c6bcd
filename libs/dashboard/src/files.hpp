#pragma once

#include "metier/http/httplib.hpp"

#include <filesystem>
#include <optional>
#include <string>

namespace metier::dashboard {

// Files of a folder, for browsers. Threads: any; waits for the disk.

/// The file of that name below a folder, with all links followed; nothing if there is none, or if
/// it is elsewhere. \param name as a request has it, decoded
std::optional<std::filesystem::path> fileBelow(const std::filesystem::path& folder,
                                               const std::string& name);

/// Answers with a file, or with 404.
void serveFile(const std::optional<std::filesystem::path>& file, httplib::Response& response);

}  // namespace metier::dashboard
