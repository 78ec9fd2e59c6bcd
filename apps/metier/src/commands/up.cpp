#include <fmt/format.h>

#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>

#include "cell_commands.hpp"
#include "metier/link/stop_signal.hpp"
#include "printable.hpp"
#include "security_options.hpp"

namespace metier::app {
namespace {

struct UpOptions {
    std::string cell;
    bool free_ports = false;
    std::string endpoints;
    server::OnFailure on_failure = server::OnFailure::restart;
};

Result<void> writeEndpoints(const std::string& file, const server::CellRunner& cell) {
    auto servers = nlohmann::json::array();
    for (const auto& server : cell.servers()) {
        servers.push_back({{"name", server.name}, {"url", server.url}});
    }
    auto controllers = nlohmann::json::array();
    for (const auto& [name, address] : cell.virtualControllers()) {
        controllers.push_back({{"name", name}, {"address", address}});
    }
    const nlohmann::json all{{"servers", servers}, {"virtual", controllers}};
    return writeFile(file, all.dump(2) + "\n");
}

/// Writes a line to standard error, which may be a closed terminal.
void say(const std::string& text) {
    std::fputs(fmt::format("metier: {}\n", printable(text)).c_str(), stderr);
}

Exit lookAfter(server::CellRunner& cell, const link::StopSignal& stop,
               server::OnFailure on_failure) {
    fmt::print("the cell is up; Ctrl-C ends it\n");
    std::fflush(stdout);
    if (const auto ended = cell.lookAfter(stop.descriptor(), on_failure, say)) {
        say(fmt::format("'{}' {}; the cell goes down", ended->name, ended->how));
        return Exit::failed;
    }
    return Exit::success;
}

Result<Exit> runUp(const UpOptions& options, const server::Security& security) {
    const link::StopSignal stop;
    link::StopSignal::outliveOutput();
    METIER_ASSIGN(const auto config, asUsage(cell::loadCell(options.cell)));
    printLabNotice(security);
    const MetierCommands commands(config, options.free_ports ? Ports::free : Ports::configured,
                                  security);
    METIER_ASSIGN(auto cell,
                  server::CellRunner::start(config, commands, stop.descriptor(),
                                            [](const server::CellRunner::Running& server) {
                                                fmt::print("{:<16} {}\n", server.name, server.url);
                                                std::fflush(stdout);
                                            }));
    if (!options.endpoints.empty()) {
        if (const auto written = writeEndpoints(options.endpoints, cell); !written) {
            return report(written.error());  // before the servers end, which takes its time
        }
    }
    return lookAfter(cell, stop, options.on_failure);
}

}  // namespace

void addUp(CLI::App& app, CommandContext& context) {
    // Shared by CLI11, which fills it, and the callback, which reads it.
    auto options = std::make_shared<UpOptions>();
    auto* command = app.add_subcommand("up", "Start every server of a cell, until Ctrl-C");
    command->footer(
        "A server that ends by itself is started again, after 0.5 s at first and 30 s at most; it\n"
        "comes up as after any start: nothing moves by itself. Ctrl-C, SIGTERM and the end of the\n"
        "terminal brake what moves and end the cell.");
    command->add_option("cell", options->cell, "The cell's file, such as cells/demo.toml")
        ->required();
    command->add_flag("--free-ports", options->free_ports,
                      "Take free ports instead of those in the file");
    command->add_option(
        "--endpoints", options->endpoints,
        "Write the names and addresses of servers and virtual controllers to this JSON file");
    command->add_flag_callback(
        "--exit-on-failure", [options] { options->on_failure = server::OnFailure::end_cell; },
        "End the whole cell when one of its processes ends by itself; exit status 1");
    command->callback(
        [options, &context] { context.exit = exitOf(runUp(*options, context.security)); });
}

}  // namespace metier::app
