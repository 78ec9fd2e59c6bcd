#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "metier/base/error.hpp"
#include "metier/composition/definition.hpp"

namespace metier::composition {

/// Reads a composition file and makes all checks that need no other file: keys, types, names,
/// whether every value exists before it is used, whether every loop ends. Waits for the disk.
/// Errors: not_found; invalid_argument, with one line "file:line: key: why" for each mistake.
Result<Definition> loadDefinition(const std::filesystem::path& file);
/// Does the same for a text. Threads: any; pure.
/// \param name stands for the file's name in messages
/// Errors: invalid_argument.
Result<Definition> parseDefinition(std::string_view text, std::string name);

/// Sorts the definitions so that each comes after those that it uses by type.
/// Errors: invalid_argument if a definition uses itself, naming the circle, or if two have one
/// name.
Result<std::vector<Definition>> inOrderOfUse(std::vector<Definition> definitions);

}  // namespace metier::composition
