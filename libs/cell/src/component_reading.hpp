#pragma once

#include <filesystem>

#include "metier/cell/cell.hpp"
#include "metier/cell/toml_file.hpp"

namespace metier::cell {

// Servers whose skills are made of those of others. What is wrong is noted in the table.

MoveComponent readMove(const TomlTable& table);
CompositionServer readComposition(const TomlTable& table, const std::filesystem::path& folder);
SynchronizedServer readSynchronized(const TomlTable& table);

}  // namespace metier::cell
