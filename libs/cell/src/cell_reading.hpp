#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "metier/cell/cell.hpp"
#include "metier/cell/toml_file.hpp"

namespace metier::cell {

// Reading of keys that several parts of a cell file have in common. Errors are noted in the table.

/// Reports whether the text is the address of a server, not its name.
bool isAddress(const std::string& server);

/// Word in place of a server's name: any server that discovery finds.
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
    std::string_view unit{};  ///< for the error message
};

/// A number within bounds.
double numberWithin(const TomlTable& table, std::string_view key, double preset,
                    const Bounds& bounds);
/// A server that others are made of: its address, or a name to be resolved.
UsedServer usedServer(const std::string& server);

/// One text, or a list of them.
std::vector<std::string> textOrTexts(const TomlTable& table, std::string_view key);

MoveComponent readMove(const TomlTable& table, const std::filesystem::path& folder);
CompositionServer readComposition(const TomlTable& table, const std::filesystem::path& folder);
SynchronizedServer readSynchronized(const TomlTable& table);
/// The table `limits` of a server.
std::vector<Limit> readLimits(const TomlTable& table);
/// The table `[records]` of a cell. A file is relative to `folder`.
Records readRecords(const TomlTable& cell, const std::filesystem::path& folder);
/// The key `metrics` of a server.
std::optional<HttpAddress> readMetrics(const TomlTable& table);

/// Reads the ways in which others find a server.
/// \param preset values of the cell, for a server; they hold for missing keys
Discovery readDiscovery(const TomlTable& table, Discovery preset);

}  // namespace metier::cell
