#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "metier/cell/cell.hpp"
#include "metier/cell/toml_file.hpp"

namespace metier::cell {

// What several parts of a cell file have in common. What is wrong is noted in the table.

/// Whether it is an address of a server, and not its name.
bool isAddress(const std::string& server);

/// What "discover" means instead of a server: any that is found.
constexpr const char* kDiscover = "discover";

/// A file below `folder`, absolute.
std::filesystem::path pathIn(const TomlTable& table, std::string_view key,
                             const std::filesystem::path& folder);
/// One file or several, at least one.
std::vector<std::filesystem::path> readFiles(const TomlTable& table, const char* key,
                                             const std::filesystem::path& folder);

struct Bounds {
    double least;
    double most;
};

/// A time [s] within bounds.
double secondsWithin(const TomlTable& table, std::string_view key, double preset,
                     const Bounds& bounds);

/// One text, or a list of them.
std::vector<std::string> textOrTexts(const TomlTable& table, std::string_view key);

/// How others find a server.
/// \param preset what the cell says, for a server
/// The table `[records]` of a cell. A file is relative to `folder`.
Records readRecords(const TomlTable& cell, const std::filesystem::path& folder);
/// The key `metrics` of a server.
std::optional<HttpAddress> readMetrics(const TomlTable& table);

/// How others find a server.
Discovery readDiscovery(const TomlTable& table, Discovery preset);

}  // namespace metier::cell
