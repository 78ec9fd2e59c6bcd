#pragma once

#include <vector>

#include "metier/configuration/limits.hpp"
#include "metier/configuration/toml_file.hpp"

namespace metier::configuration {

/// The limits of a server, from its table `limits`. What is wrong is noted in the table.
std::vector<Limit> readLimits(const TomlTable& table);

}  // namespace metier::configuration
