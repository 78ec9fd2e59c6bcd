#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "metier/base/error.hpp"
#include "metier/composition/definition.hpp"
#include "metier/skill/skill_type.hpp"

namespace metier::composition {

/// Reads a file of skill types (docs/guide/skill-types.md). Waits for the disk.
/// Errors: not_found; invalid_argument, with one line "file:line: key: why" for each mistake.
Result<skill::SkillTypes> loadSkillTypes(const std::filesystem::path& file);
/// Does the same for a text. Threads: any; pure.
/// \param name stands for the file's name in messages
/// Errors: invalid_argument.
Result<skill::SkillTypes> parseSkillTypes(std::string_view text, std::string name);

/// The type that a composition declares for its own skill. Threads: any; pure.
/// \param description of the composed skill
skill::SkillTypes skillTypesOf(const Definition& definition,
                               const skill::SkillDescription& description);

}  // namespace metier::composition
