#include <fmt/format.h>

#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>

#include "cell_runner.hpp"
#include "commands.hpp"
#include "security.hpp"
#include "stop_signal.hpp"

namespace metier::app {
namespace {

struct UpOptions {
    std::string cell;
    bool free_ports = false;
    std::string endpoints;
};

Result<void> writeEndpoints(const std::string& file, const CellRunner& cell) {
    auto servers = nlohmann::json::array();
    for (const auto& server : cell.servers()) {
        servers.push_back({{"name", server.name}, {"url", server.url}});
    }
    auto controllers = nlohmann::json::array();
    for (const auto& [name, address] : cell.virtualControllers()) {
        controllers.push_back({{"name", name}, {"address", address}});
    }
    std::ofstream out(file);
    out << nlohmann::json{{"servers", servers}, {"virtual", controllers}}.dump(2) << '\n';
    if (!out.flush()) {
        return fail(Errc::invalid_argument, fmt::format("{}: cannot be written", file));
    }
    return {};
}

Exit supervise(CellRunner& cell, const StopSignal& stop) {
    fmt::print("the cell is up; Ctrl-C ends it\n");
    std::fflush(stdout);
    if (const auto ended = cell.waitForEnd(stop.descriptor())) {
        fmt::print(stderr, "metier: '{}' ended with status {}; the cell goes down\n", ended->name,
                   ended->status);
        return Exit::failed;
    }
    return Exit::success;
}

Exit runUp(const UpOptions& options) {
    const StopSignal stop;
    const auto config = configuration::loadCell(options.cell);
    if (!config) {
        return reportUsage(config.error());
    }
    if (isInsecureLab()) {
        fmt::print(stderr, "{}\n", kInsecureLab);
    }
    const auto ports = options.free_ports ? CellRunner::Ports::free : CellRunner::Ports::configured;
    auto cell = CellRunner::start(*config, ports, [](const CellRunner::Running& server) {
        fmt::print("{:<16} {}\n", server.name, server.url);
        std::fflush(stdout);
    });
    if (!cell) {
        return report(cell.error());
    }
    if (!options.endpoints.empty()) {
        if (const auto written = writeEndpoints(options.endpoints, *cell); !written) {
            return reportUsage(written.error());
        }
    }
    return supervise(*cell, stop);
}

}  // namespace

void addUp(CLI::App& app, Exit& exit) {
    // Shared by CLI11, which fills it, and the callback, which reads it.
    auto options = std::make_shared<UpOptions>();
    auto* command = app.add_subcommand("up", "Start every server of a cell, until Ctrl-C");
    command->add_option("cell", options->cell, "The cell's file, such as cells/demo.toml")
        ->required();
    command->add_flag("--free-ports", options->free_ports,
                      "Take free ports instead of those in the file");
    command->add_option(
        "--endpoints", options->endpoints,
        "Write the names and addresses of servers and virtual controllers to this JSON file");
    command->callback([options, &exit] { exit = runUp(*options); });
}

}  // namespace metier::app
