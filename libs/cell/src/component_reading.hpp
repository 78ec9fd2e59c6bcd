#pragma once

#include <filesystem>

#include "metier/cell/cell.hpp"
#include "metier/cell/toml_file.hpp"

namespace metier::cell {

// Reading of servers whose skills are made of skills of other servers. Errors are noted in the
// table.

MoveComponent readMove(const TomlTable& table);
CompositionServer readComposition(const TomlTable& table, const std::filesystem::path& folder);
SynchronizedServer readSynchronized(const TomlTable& table);

}  // namespace metier::cell
