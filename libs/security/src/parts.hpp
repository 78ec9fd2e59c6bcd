#pragma once

#include <cstdint>
#include <filesystem>

namespace metier::security {

/// The file of a part of a log, which is kept in several once it is long: "a.log", "a.2.log", ...
/// \param number from 1
std::filesystem::path partOf(const std::filesystem::path& log, std::uint32_t number);
/// The number of the last part in the folder, though others be missing; at least 1.
std::uint32_t lastPart(const std::filesystem::path& log);

}  // namespace metier::security
