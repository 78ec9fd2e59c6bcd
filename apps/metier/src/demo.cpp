#include <fmt/format.h>
#include <unistd.h>

#include <memory>
#include <optional>
#include <utility>

#include "cell_runner.hpp"
#include "commands.hpp"
#include "pick_place_command.hpp"
#include "security.hpp"
#include "square_command.hpp"
#include "stop_signal.hpp"

namespace metier::app {
namespace {

struct DemoOptions {
    std::string cell;
    bool headless = false;
    bool free_ports = false;
    std::string pick_and_place;
    SquareSettings settings;
    SquareOutput output;
};

void waitForEnter(CellRunner& cell) {
    fmt::print(
        "\nThe cell stays up: connect UaExpert to an address above, or try `metier{0} list URL` "
        "and\n"
        "`metier{0} run URL SKILL --fields` in another terminal. Enter or Ctrl-C ends it.\n",
        isInsecureLab() ? " --insecure-lab" : "");
    std::fflush(stdout);
    if (const auto ended = cell.waitForEnd(STDIN_FILENO)) {
        fmt::print(stderr, "metier: '{}' ended with status {}\n", ended->name, ended->status);
    }
}

Result<CellRunner> startCell(const std::string& file, const DemoOptions& options) {
    const auto config = configuration::loadCell(file);
    if (!config) {
        return fail(config.error());
    }
    fmt::print(stderr, "the servers of the cell '{}':\n", config->name);
    const auto ports = options.free_ports ? CellRunner::Ports::free : CellRunner::Ports::configured;
    return CellRunner::start(*config, ports, [](const CellRunner::Running& server) {
        fmt::print(stderr, "  {:<16} {}\n", server.name, server.url);
    });
}

std::vector<std::string> addressesOf(const CellRunner& cell) {
    std::vector<std::string> urls;
    for (const auto& server : cell.servers()) {
        urls.push_back(server.url);
    }
    return urls;
}

/// Squares in the first cell, then parts in the second; both stay up for whoever wants to look.
Exit runDemo(const DemoOptions& options) {
    if (isInsecureLab()) {
        fmt::print(stderr, "{}\n", kInsecureLab);
    }
    auto started = startCell(options.cell, options);
    if (!started) {
        return started.error().code == Errc::invalid_argument ? reportUsage(started.error())
                                                              : report(started.error());
    }
    std::optional<CellRunner> cell(std::move(*started));
    auto exit = moveAlongSquares(addressesOf(*cell), options.settings, options.output);
    std::optional<CellRunner> second;
    if (exit == Exit::success && !options.pick_and_place.empty()) {
        if (options.headless) {
            cell.reset();
        }
        auto more = startCell(options.pick_and_place, options);
        if (!more) {
            return report(more.error());
        }
        second.emplace(std::move(*more));
        exit = pickAndPlace(addressesOf(*second), PickPlaceSettings());
    }
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
    command->add_option("--pick-and-place", options->pick_and_place,
                        "Then a cell whose PickPlaceSkills move ten parts each");
    addSquareOptions(*command, options->settings, options->output);
    command->callback([options, &exit] { exit = runDemo(*options); });
}

}  // namespace metier::app
