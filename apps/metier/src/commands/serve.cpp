#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <memory>
#include <optional>
#include <utility>

#include "metier/link/start_watch.hpp"
#include "metier/link/stop_signal.hpp"
#include "metier/server/ready_line.hpp"
#include "metier/server/server.hpp"
#include "metier/server/state_choice.hpp"
#include "recorded.hpp"
#include "security_options.hpp"

namespace metier::app {
namespace {

// Longest time from the signal to the end of the process; the arm brakes within 2 s of it.
constexpr std::chrono::seconds kLongestEnd{10};

struct ServeOptions {
    std::string cell;
    std::string server;
    std::optional<std::uint16_t> port;
    std::uint16_t again_at = 0;
    bool lab_is_known = false;
    std::string robot;
    std::string controller;
    std::string sensor;
    std::vector<std::string> used;
    std::string state;
    std::vector<std::string> discovery;
    std::string announce_as;
    std::string records;
    std::string metrics;
};

Result<void> chooseMetrics(const ServeOptions& options, cell::ServerConfig& config) {
    if (options.metrics == "off") {
        config.metrics.reset();
    } else if (!options.metrics.empty()) {
        auto address = cell::parseHttpAddress(options.metrics);
        if (!address) {
            return fail(address.error().code, "--metrics " + address.error().message);
        }
        config.metrics = std::move(*address);
    }
    return {};
}

void chooseControllers(const ServeOptions& options, cell::ServerConfig& config) {
    const auto choose = [](const std::string& other_address, cell::DriverChoice& driver) {
        driver.controller = other_address.empty() ? driver.controller : other_address;
    };
    if (auto* gripper = config.as<cell::GripperServer>()) {
        choose(options.controller, gripper->driver);
    }
    if (auto* arm = config.as<cell::ArmServer>()) {
        choose(options.controller, arm->driver);
        if (arm->force_torque_sensor) {
            choose(options.sensor, *arm->force_torque_sensor);
        }
    }
}

/// Addresses of used servers that the command line says instead of the file.
Result<void> chooseUsed(const std::vector<std::string>& given, cell::ServerConfig& config) {
    if (config.driver() != nullptr) {
        return {};  // it has a device and uses no other server
    }
    const auto used = config.usedServers();
    for (const auto& option : given) {
        const auto equals = option.find('=');
        const auto found = std::find_if(used.begin(), used.end(), [&](const auto& server) {
            return server.name == option.substr(0, equals);
        });
        if (equals == std::string::npos || found == used.end()) {
            return fail(Errc::invalid_argument,
                        fmt::format("--use {}: is not NAME=opc.tcp://... with a name of `servers`",
                                    option));
        }
        found->url = option.substr(equals + 1);
    }
    return {};
}

Result<cell::ServerConfig> chosenServer(const cell::CellConfig& cell, const ServeOptions& options) {
    const auto* server = options.server.empty() && cell.servers.size() == 1
                             ? &cell.servers.front()
                             : cell.find(options.server);
    if (server == nullptr) {
        std::string names;
        for (const auto& known : cell.servers) {
            names += (names.empty() ? "" : ", ") + known.name;
        }
        return fail(Errc::invalid_argument,
                    fmt::format("{}: no server '{}'; choose one with --server: {}",
                                cell.file.string(), options.server, names));
    }
    auto config = *server;
    config.port = options.port.value_or(config.port);
    server::chooseState(config, {.folder = options.state, .records = options.records});
    METIER_TRY(chooseMetrics(options, config));
    if (auto* move = config.as<cell::MoveComponent>(); move != nullptr && !options.robot.empty()) {
        move->robot = options.robot;
        move->discover = false;
    }
    if (!options.discovery.empty()) {
        config.discovery.servers = options.discovery;
    }
    if (!options.announce_as.empty()) {
        config.discovery.announce_as = options.announce_as;
    }
    chooseControllers(options, config);
    METIER_TRY(chooseUsed(options.used, config));
    return cell.resolved(std::move(config));
}

/// Serves until the signal; then it brakes what moves and ends.
Result<Exit> serveUntil(const link::StopSignal& stop, const cell::ServerConfig& config,
                        const server::Identity& identity, const ServeOptions& options) {
    auto starting = std::make_unique<link::StartWatch>(stop);
    auto started = server::start(config, {identity, device::drivers(), stop});
    starting.reset();
    METIER_ASSIGN(const auto server, std::move(started));
    if (!options.lab_is_known) {
        warnOfLab(identity.security(), "metier " + options.server, server->url());
    }
    fmt::print("{}\n", server::readyLine(server->url()));
    std::fflush(stdout);
    stop.wait();
    link::StopSignal::endWithin(kLongestEnd);
    return Exit::success;
}

Result<Exit> runServe(const ServeOptions& options, const server::Security& security) {
    const link::StopSignal stop;
    link::StopSignal::outliveOutput();
    METIER_ASSIGN(const auto cell, asUsage(cell::loadCell(options.cell)));
    METIER_ASSIGN(auto config, asUsage(chosenServer(cell, options)));
    METIER_ASSIGN(const auto identity, server::identityOf(config, security));
    if (config.port == 0) {
        config.port = options.again_at;
    }
    return serveUntil(stop, config, identity, options);
}

}  // namespace

void addServe(CLI::App& app, CommandContext& context) {
    // Shared by CLI11, which fills it, and the callback, which reads it.
    auto options = std::make_shared<ServeOptions>();
    auto* command = app.add_subcommand(
        "serve", "Start one server of a cell, until Ctrl-C; prints 'ready URL' once it serves");
    command->add_option("cell", options->cell, "The cell's file")->required();
    command->add_option("--server", options->server, "Name of the server, if the file has several");
    command->add_option("--port", options->port, "Another TCP port than the file's; 0: a free one");
    command
        ->add_option("--again-at", options->again_at,
                     // For `metier up`, when it restarts a server.
                     "With --port 0: the free port that the server had before it ended")
        ->group("");
    command
        ->add_flag("--lab-is-known", options->lab_is_known,
                   "Do not warn of an insecure lab: who started this has")
        ->group("");
    command->add_option("--robot", options->robot,
                        "Another opc.tcp:// address of the robot than the file's");
    command->add_option("--controller", options->controller,
                        "Another address of the device's controller than the file's");
    command->add_option("--sensor", options->sensor,
                        "Another address of the force-torque sensor than the file's");
    command->add_option("--use", options->used,
                        "Another address of a used server than the file's, as NAME=opc.tcp://...");
    command->add_option("--discovery", options->discovery,
                        "Other discovery servers than the file's, as opc.tcp://host:4840");
    command->add_option("--announce-as", options->announce_as,
                        "Host by which others reach the server, instead of the file's");
    command->add_option("--state", options->state,
                        "Folder for what outlives the server: the names of executions. Else that "
                        "of the user, and none with --port 0");
    command
        ->add_option("--records", options->records,
                     "Where every execution is recorded, instead of the file's: a file, "
                     "postgresql://..., or off. Else records.db in the state folder")
        ->check(withoutPassword());
    command->add_option(
        "--metrics", options->metrics,
        "Publish figures at http://ADDRESS:PORT/metrics and /healthz, instead of the "
        "file's; PORT alone is one of 127.0.0.1; off");
    command->callback(
        [options, &context] { context.exit = exitOf(runServe(*options, context.security)); });
}

}  // namespace metier::app
