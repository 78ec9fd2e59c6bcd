#include <fmt/format.h>
#include <unistd.h>

#include <chrono>
#include <memory>
#include <optional>
#include <utility>

#include "cell_commands.hpp"
#include "metier/base/wake_up_delay.hpp"
#include "metier/link/stop_signal.hpp"
#include "pick_place_run.hpp"
#include "security_options.hpp"
#include "squares.hpp"

namespace metier::app {
namespace {

constexpr int kNoDescriptor = -1;

/// Second tries of a move or part that failed, as on a busy machine. None in a cell with a real
/// device: no real robot shall move by itself after a stop.
int secondTries(const cell::CellConfig& cell) {
    constexpr int kOfVirtualCells = 2;
    return cell.isVirtual() ? kOfVirtualCells : 0;
}

struct DemoOptions {
    std::string cell;
    bool headless = false;
    bool free_ports = false;
    std::string pick_and_place;
    SquareSettings settings;
    SquareOutput output;
};

/// Waits for Enter; Ctrl-C ends the program, and the cell with it.
void waitForEnter(server::CellRunner& cell, const server::Security& security) {
    fmt::print(
        "\nThe cell stays up: connect UaExpert to an address above, or try `metier{0} list URL` "
        "and\n"
        "`metier{0} run URL SKILL --fields` in another terminal. Enter or Ctrl-C ends it.\n",
        security.insecure_lab ? " --insecure-lab" : "");
    std::fflush(stdout);
    cell.lookAfter(STDIN_FILENO, server::OnFailure::restart,
                   [](const std::string& text) { fmt::print(stderr, "metier: {}\n", text); });
}

/// A cell that runs.
struct DemoCell {
    server::CellRunner servers;
    int second_tries = 0;
};

Result<DemoCell> startCell(const std::string& file, const DemoOptions& options,
                           const server::Security& security) {
    METIER_ASSIGN(const auto cell, cell::loadCell(file));
    fmt::print(stderr, "the servers of the cell '{}':\n", cell.name);
    const MetierCommands commands(cell, options.free_ports ? Ports::free : Ports::configured,
                                  security);
    METIER_ASSIGN(auto started,
                  server::CellRunner::start(
                      cell, commands, kNoDescriptor, [](const server::CellRunner::Running& server) {
                          fmt::print(stderr, "  {:<16} {}\n", server.name, server.url);
                      }));
    return DemoCell{std::move(started), secondTries(cell)};
}

std::vector<std::string> addressesOf(const server::CellRunner& cell) {
    std::vector<std::string> urls;
    for (const auto& server : cell.servers()) {
        urls.push_back(server.url);
    }
    return urls;
}

/// Says so if something failed because others have the processors of this machine.
/// \return whether it was that
bool tellTooSlow(Exit exit, WakeUpDelay& delay) {
    constexpr std::chrono::milliseconds kTooLate{100};
    const std::chrono::nanoseconds longest = delay.takeLongest();
    if (exit == Exit::success || longest < kTooLate) {
        return false;
    }
    fmt::print(stderr,
               "metier: this machine is too slow for all of it: a thread woke up {:.2f} s late, "
               "0.10 s is too much for these controllers; the demo goes on\n",
               std::chrono::duration<double>(longest).count());
    return true;
}

/// Parts in a second cell.
Result<Exit> runPickAndPlace(const DemoOptions& options, const CommandContext& context,
                             std::optional<DemoCell>& cell, WakeUpDelay& delay) {
    METIER_ASSIGN(auto started, startCell(options.pick_and_place, options, context.security));
    cell.emplace(std::move(started));
    PickPlaceSettings settings;
    settings.second_tries = cell->second_tries;
    const auto exit = exitOf(pickAndPlace(context.identity, addressesOf(cell->servers), settings));
    tellTooSlow(exit, delay);
    return exit;
}

/// Draws squares in the first cell, then moves parts in the second; both keep running until Enter.
Result<Exit> runDemo(const DemoOptions& options, const CommandContext& context) {
    link::StopSignal::outliveOutput();
    printLabNotice(context.security);
    METIER_ASSIGN(auto started, startCell(options.cell, options, context.security));
    std::optional<DemoCell> cell(std::move(started));
    WakeUpDelay delay;
    auto settings = options.settings;
    settings.second_tries = cell->second_tries;
    auto exit = exitOf(
        moveAlongSquares(context.identity, addressesOf(cell->servers), settings, options.output));
    const bool go_on = tellTooSlow(exit, delay) || exit == Exit::success;
    std::optional<DemoCell> second;
    if (go_on && !options.pick_and_place.empty()) {
        if (options.headless) {
            cell.reset();
        }
        const auto parts = exitOf(runPickAndPlace(options, context, second, delay));
        exit = exit == Exit::success ? parts : exit;
    }
    if (!options.headless) {
        waitForEnter(cell->servers, context.security);
    }
    return exit;
}

}  // namespace

void addDemo(CLI::App& app, CommandContext& context) {
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
    command->footer(
        "In a cell without real devices, a move or a part that failed is tried again twice. If it\n"
        "fails for good because the machine is too slow, the demo says so with a figure, and goes "
        "on.\n"
        "Exit status 1 if anything failed.");
    addSquareOptions(*command, options->settings, options->output);
    command->callback([options, &context] { context.exit = exitOf(runDemo(*options, context)); });
}

}  // namespace metier::app
