#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "metier/virtual_controller/world_link.hpp"

namespace metier::virtual_controller {

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
/// Needed is only "name"; "time" is 0 without it, and a pose whose quaternion is no rotation is
/// left out.
std::optional<NamedReport> reportOf(std::string_view line);
/// Effect of a line; nothing as above.
/// Needed is "wrench" with six numbers.
std::optional<WorldEffect> effectOf(std::string_view line);

}  // namespace metier::virtual_controller
