#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "metier/base/error.hpp"

namespace metier::security {

enum class Readers { owner, everybody };

/// Writes a file whole or not at all: a reader sees the old or the new content, also after a loss
/// of power. Missing folders are made, accessible to their owner only.
/// Errors: resource_unavailable.
Result<void> writeWhole(const std::filesystem::path& file, std::string_view content,
                        Readers readers);

/// The content of a file, up to 64 kB, that its owner alone may read.
/// Errors: not_found; access_denied (others may read it).
Result<std::string> readPrivate(const std::filesystem::path& file);

}  // namespace metier::security
