#pragma once

#include <filesystem>

#include "metier/configuration/cell.hpp"
#include "metier/configuration/toml_file.hpp"

namespace metier::configuration {

// Servers whose skills are made of those of others. What is wrong is noted in the table.

MoveComponent readMove(const TomlTable& table);
CompositionServer readComposition(const TomlTable& table, const std::filesystem::path& folder);
SynchronizedServer readSynchronized(const TomlTable& table);

}  // namespace metier::configuration
