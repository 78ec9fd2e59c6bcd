#pragma once

#include <vector>

#include "metier/cell/limits.hpp"
#include "metier/cell/toml_file.hpp"

namespace metier::cell {

/// Reads the limits of a server from its table `limits`. Errors are noted in the table.
std::vector<Limit> readLimits(const TomlTable& table);

}  // namespace metier::cell
