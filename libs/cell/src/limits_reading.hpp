#pragma once

#include <vector>

#include "metier/cell/limits.hpp"
#include "metier/cell/toml_file.hpp"

namespace metier::cell {

/// The limits of a server, from its table `limits`. What is wrong is noted in the table.
std::vector<Limit> readLimits(const TomlTable& table);

}  // namespace metier::cell
