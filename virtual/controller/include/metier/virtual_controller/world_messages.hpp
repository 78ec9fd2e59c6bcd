#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "metier/virtual_controller/world_link.hpp"

namespace metier::virtual_controller {

// Messages between a controller and the world: a line of JSON each.

// Messages between a controller and the world: a line of JSON each. Threads: any; pure.
/// A report with its sender.
struct NamedReport {
    /// Name of the controller.
    std::string name;
    /// State of its device.
    WorldReport report;
};

/// Line for a report, with its line feed.
std::string toLine(const NamedReport& report);
/// Line for an effect, with its line feed.
std::string toLine(const WorldEffect& effect);
/// Report of a line; nothing if the line is not such a message or a number in it is not finite.
std::optional<NamedReport> reportOf(std::string_view line);
/// Effect of a line; nothing as above.
std::optional<WorldEffect> effectOf(std::string_view line);

}  // namespace metier::virtual_controller
