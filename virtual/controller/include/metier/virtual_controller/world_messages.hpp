#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "metier/virtual_controller/world_link.hpp"

namespace metier::virtual_controller {

// Messages between a controller and the world: a line of JSON each.

struct NamedReport {
    std::string name;  ///< name of the controller
    WorldReport report;
};

std::string toLine(const NamedReport& report);
std::string toLine(const WorldEffect& effect);
/// Parsers; nothing if the line is not such a message or a number in it is not finite.
std::optional<NamedReport> reportOf(std::string_view line);
std::optional<WorldEffect> effectOf(std::string_view line);

}  // namespace metier::virtual_controller
