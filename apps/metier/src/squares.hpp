#pragma once

#include <string>
#include <vector>

#include "command_context.hpp"
#include "square_run.hpp"

namespace metier::app {

struct SquareOutput {
    std::string svg = "square.svg";
    bool json = false;
};

/// Adds the options of a square to a command.
void addSquareOptions(CLI::App& command, SquareSettings& settings, SquareOutput& output);

/// Moves every arm of the servers along its square, all at the same time; shows the progress and
/// prints the result.
/// Errors: a server that does not answer; no arm that can go along a square.
Result<Exit> moveAlongSquares(const CommandIdentity& identity, const std::vector<std::string>& urls,
                              const SquareSettings& settings, const SquareOutput& output);

}  // namespace metier::app
