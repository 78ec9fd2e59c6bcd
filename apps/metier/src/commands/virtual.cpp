// metier virtual: controllers without their devices, and what is done to them.
#include <fmt/format.h>
#include <poll.h>

#include <chrono>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <thread>

#include "command_context.hpp"
#include "metier/base/text.hpp"
#include "metier/cell/cell.hpp"
#include "metier/link/stop_signal.hpp"
#include "metier/link/tcp_link.hpp"
#include "metier/motion/robot_model.hpp"
#include "metier/server/ready_line.hpp"
#include "metier/virtual_controller/host.hpp"

namespace metier::app {
namespace {

using namespace std::chrono_literals;
using virtual_controller::Host;

constexpr std::uint16_t kControlPort = 7400;
// Longest time that a controller stays for its servers, if all get the signal at the same moment:
// they brake first.
constexpr auto kLongestCompany = 3s;
constexpr auto kLongestControllerEnd = 10s;

struct VirtualRunOptions {
    std::string cell;
    std::string name;
    std::string address;
    std::string world;
};

Result<Exit> runController(const VirtualRunOptions& options) {
    const link::StopSignal stop;
    link::StopSignal::outliveOutput();
    METIER_ASSIGN(const auto cell, cell::loadCell(options.cell));
    const auto* controller = cell.findVirtual(options.name);
    if (controller == nullptr) {
        return fail(Errc::invalid_argument,
                    fmt::format("{}: no virtual controller \"{}\"", options.cell, options.name));
    }
    std::optional<motion::RobotModel> model;
    if (!controller->model.empty()) {
        METIER_ASSIGN(model, motion::RobotModel::load(controller->model));
    }
    const auto* world = cell.world();
    const bool has_world = world != nullptr && world != controller;
    virtual_controller::HostOptions host_options;
    host_options.name = controller->name;
    host_options.type = controller->type;
    host_options.address = options.address.empty() ? controller->address : options.address;
    host_options.settings = controller->settings;
    host_options.model = model ? &*model : nullptr;
    host_options.world_address =
        !options.world.empty() ? options.world : (has_world ? world->address : "");
    host_options.control_port = controller->control_port;
    METIER_ASSIGN(auto host,
                  Host::start(std::move(host_options), virtual_controller::controllerTypes()));
    fmt::print("{}\n", server::readyVirtualLine(options.address.empty() ? controller->address
                                                                        : options.address));
    std::fflush(stdout);
    std::jthread running([&] { host->run(); });
    stop.wait();
    link::StopSignal::endWithin(kLongestControllerEnd);
    host->stopOnceAlone(kLongestCompany);
    return Exit::success;
}

struct ControlOptions {
    std::string target;
    std::string cell;
    std::string fault;
    std::string value;
};

/// "127.0.1.1", "127.0.1.1:7400", or the name of a virtual controller of the cell file.
Result<std::pair<std::string, std::uint16_t>> controlAddress(const ControlOptions& options) {
    if (!options.cell.empty()) {
        METIER_ASSIGN(const auto cell, cell::loadCell(options.cell));
        const auto* controller = cell.findVirtual(options.target);
        if (controller == nullptr) {
            return fail(Errc::invalid_argument, fmt::format("{}: no virtual controller \"{}\"",
                                                            options.cell, options.target));
        }
        return std::pair(controller->address, controller->control_port);
    }
    const auto colon = options.target.find(':');
    std::uint16_t port = kControlPort;
    if (colon != std::string::npos) {
        const auto given =
            numberIn<std::uint16_t>(std::string_view(options.target).substr(colon + 1));
        if (!given) {
            return fail(Errc::invalid_argument,
                        fmt::format("\"{}\" is not an address with a port", options.target));
        }
        port = *given;
    }
    return std::pair(options.target.substr(0, colon), port);
}

/// One line for one line.
Result<nlohmann::ordered_json> ask(const ControlOptions& options,
                                   const nlohmann::ordered_json& request) {
    METIER_ASSIGN(const auto address, controlAddress(options));
    const auto deadline = std::chrono::steady_clock::now() + 5s;
    METIER_ASSIGN(auto link, link::TcpLink::connect(address.first, address.second, deadline));
    const auto line = request.dump() + "\n";
    METIER_TRY(link.send(std::as_bytes(std::span(line)), deadline));
    std::string answer;
    while (answer.find('\n') == std::string::npos) {
        std::array<char, 4096> buffer{};
        METIER_ASSIGN(const auto count,
                      link.receive(std::as_writable_bytes(std::span(buffer)), deadline));
        answer.append(buffer.data(), count);
    }
    auto parsed = nlohmann::ordered_json::parse(answer, nullptr, false);
    if (parsed.is_object() && parsed.contains("error") && parsed.at("error").is_string()) {
        return fail(Errc::invalid_argument, parsed.at("error").get<std::string>());
    }
    return parsed;
}

Result<Exit> inject(const ControlOptions& options) {
    if (options.fault.empty()) {
        METIER_ASSIGN(const auto help, ask(options, {{"help", true}}));
        for (const auto& [name, text] : help.items()) {
            fmt::print("{:<24} {}\n", name, text.get<std::string>());
        }
    } else {
        METIER_TRY(ask(options, {{"inject", options.fault}, {"value", options.value}}));
    }
    return Exit::success;
}

Result<Exit> showState(const ControlOptions& options) {
    METIER_ASSIGN(const auto state, ask(options, {{"state", true}}));
    fmt::print("{}\n", state.dump(2));
    return Exit::success;
}

void listTypes() {
    for (const auto& type : virtual_controller::controllerTypes()) {
        fmt::print("{:<10} {}\n", type.name, type.help);
    }
}

void addTarget(CLI::App& command, ControlOptions& options) {
    command
        .add_option("target", options.target,
                    "ADDRESS or ADDRESS:PORT of its control port, or its name in the cell")
        ->required();
    command.add_option("--cell", options.cell, "The cell's file in which the name is");
}

}  // namespace

void addVirtual(CLI::App& app, CommandContext& context) {
    auto* command =
        app.add_subcommand("virtual", "Controllers without their devices: run them, break them");
    command->require_subcommand(1);

    // Shared by CLI11, which fills them, and the callbacks, which read them.
    auto run = std::make_shared<VirtualRunOptions>();
    auto* run_command = command->add_subcommand(
        "run", "Run one virtual controller of a cell, until Ctrl-C; `metier up` runs all");
    run_command->add_option("cell", run->cell, "The cell's file")->required();
    run_command->add_option("name", run->name, "Its name in the file")->required();
    run_command->add_option("--address", run->address, "Another address than the file's");
    run_command->add_option("--world", run->world, "Address of the world, if not the file's");
    run_command->callback([run, &context] { context.exit = exitOf(runController(*run)); });

    auto control = std::make_shared<ControlOptions>();
    auto* inject_command = command->add_subcommand(
        "inject", "Inject a fault into a virtual controller; without a fault: list them");
    addTarget(*inject_command, *control);
    inject_command->add_option("fault", control->fault, "What happens, as emergency-stop");
    inject_command->add_option("value", control->value, "Its argument, if it has one");
    inject_command->callback([control, &context] { context.exit = exitOf(inject(*control)); });

    auto* state_command = command->add_subcommand("state", "Show a virtual controller as JSON");
    addTarget(*state_command, *control);
    state_command->callback([control, &context] { context.exit = exitOf(showState(*control)); });

    auto* list_command = command->add_subcommand("list", "The types of virtual controllers");
    list_command->callback(&listTypes);
}

}  // namespace metier::app
