#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "metier/base/error.hpp"
#include "metier/composition/definition.hpp"

namespace metier::server {

/// All files, each after those that it uses.
/// Errors: everything that is wrong with any of them.
Result<std::vector<composition::Definition>> loadDefinitions(
    const std::vector<std::filesystem::path>& files);

/// Tells the executions of this life of a server from those before.
std::string newLife();

}  // namespace metier::server
