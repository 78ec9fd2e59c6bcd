#pragma once

#include <optional>
#include <string>
#include <vector>

#include "metier/base/error.hpp"
#include "square_run.hpp"

namespace metier::app {

/// Outcome of one arm: its result, or the reason why there is none.
struct SquareOutcome {
    std::string name;
    std::string url;
    Result<SquareResult> result;
};

/// A table for the terminal.
std::string tableOf(const std::vector<SquareOutcome>& outcomes);
std::string jsonOf(const std::vector<SquareOutcome>& outcomes);

/// Writes the picture of all paths, and makes its folder if it is missing.
/// Errors: invalid_argument if the file cannot be written.
Result<void> writePicture(const std::string& file, const std::vector<SquareOutcome>& outcomes);

}  // namespace metier::app
