#pragma once

#include <spdlog/formatter.h>

#include <memory>
#include <string>
#include <string_view>

namespace metier::app {

/// Text that may come from a server, a client or a controller, made fit for a terminal line by
/// line, as opcua::sanitise() does.
std::string printable(std::string_view text);

/// A log in which every text is printable. Further lines of one message are indented: no text from
/// outside looks like a line of the log.
/// \param pattern as spdlog takes it
std::unique_ptr<spdlog::formatter> printableLog(const std::string& pattern);

}  // namespace metier::app
