#include <fmt/format.h>
#include <unistd.h>

#include <memory>

#include "cell_runner.hpp"
#include "commands.hpp"
#include "square_command.hpp"
#include "stop_signal.hpp"

namespace metier::app {
namespace {

struct DemoOptions {
    std::string cell;
    bool headless = false;
    bool free_ports = false;
    SquareSettings settings;
    SquareOutput output;
};

void waitForEnter(CellRunner& cell) {
    fmt::print(
        "\nThe cell stays up: connect UaExpert to an address above, or try `metier list` and\n"
        "`metier run URL SKILL --fields` in another terminal. Enter or Ctrl-C ends it.\n");
    std::fflush(stdout);
    if (const auto ended = cell.waitForEnd(STDIN_FILENO)) {
        fmt::print(stderr, "metier: '{}' ended with status {}\n", ended->name, ended->status);
    }
}

Exit runDemo(const DemoOptions& options) {
    const auto config = configuration::loadCell(options.cell);
    if (!config) {
        return reportUsage(config.error());
    }
    fmt::print(stderr, "the servers of the cell '{}':\n", config->name);
    const auto ports = options.free_ports ? CellRunner::Ports::free : CellRunner::Ports::configured;
    auto cell = CellRunner::start(*config, ports, [](const CellRunner::Running& server) {
        fmt::print(stderr, "  {:<16} {}\n", server.name, server.url);
    });
    if (!cell) {
        return report(cell.error());
    }
    std::vector<std::string> urls;
    for (const auto& server : cell->servers()) {
        urls.push_back(server.url);
    }
    const auto exit = moveAlongSquares(urls, options.settings, options.output);
    if (!options.headless) {
        waitForEnter(*cell);
    }
    return exit;
}

}  // namespace

void addDemo(CLI::App& app, Exit& exit) {
    // Shared by CLI11, which fills it, and the callback, which reads it.
    auto options = std::make_shared<DemoOptions>();
    auto* command = app.add_subcommand(
        "demo", "Start a cell and move every arm of it along a square: up and square in one");
    command->add_option("cell", options->cell, "The cell's file, such as cells/demo.toml")
        ->required();
    command->add_flag("--headless", options->headless, "End when the squares are done");
    command->add_flag("--free-ports", options->free_ports,
                      "Take free ports instead of those in the file");
    addSquareOptions(*command, options->settings, options->output);
    command->callback([options, &exit] { exit = runDemo(*options); });
}

}  // namespace metier::app
