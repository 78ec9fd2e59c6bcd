#pragma once

#include <string_view>

#include "metier/base/clock.hpp"
#include "metier/base/error.hpp"

namespace metier::app {

/// Reads a time from the command line: UTC as 2026-11-22, 2026-11-22T09:30, 2026-11-22T09:30:05.5Z,
/// or the time before `now` as 90s, 30m, 8h, 7d.
/// Errors: invalid_argument, with the text.
Result<UtcTime> parseTime(std::string_view text, UtcTime now);

}  // namespace metier::app
