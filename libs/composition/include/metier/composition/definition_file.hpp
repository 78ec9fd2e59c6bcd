#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "metier/base/error.hpp"
#include "metier/composition/definition.hpp"

namespace metier::composition {

/// Reads a composition file and checks all that the file alone tells: keys, types, names, whether
/// every value is there before it is used, whether every loop ends.
/// Errors: not_found; invalid_argument with a line "file:line: key: why" for all that is wrong.
Result<Definition> loadDefinition(const std::filesystem::path& file);
/// The same from text; `name` stands for the file in messages.
Result<Definition> parseDefinition(std::string_view text, std::string name);

/// The definitions in an order in which each comes after those it uses by type.
/// Errors: invalid_argument, naming the way around, if one uses itself; two of one name.
Result<std::vector<Definition>> inOrderOfUse(std::vector<Definition> definitions);

}  // namespace metier::composition
