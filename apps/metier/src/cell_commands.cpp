#include "cell_commands.hpp"

#include <fmt/format.h>

#include <filesystem>

#include "metier/base/overloaded.hpp"
#include "metier/base/random.hpp"
#include "security.hpp"

namespace metier::app {
namespace {

std::string self() {
    return std::filesystem::read_symlink("/proc/self/exe").string();
}

/// Some address of this machine that nobody else is likely to use.
std::string freeAddress() {
    const auto part = [](std::uint64_t low, std::uint64_t high) {
        return low + randomNumber() % (high - low + 1);
    };
    return fmt::format("127.{}.{}.{}", part(1, 254), part(0, 255), part(1, 254));
}

/// Options of `metier serve` for the servers that a server uses.
void addUsed(const cell::ServerConfig& server, const CellAddresses& known,
             std::vector<std::string>& command) {
    if (const auto* move = server.as<cell::MoveComponent>()) {
        const auto robot = known.servers.find(move->robot);
        if (robot != known.servers.end()) {
            command.insert(command.end(), {"--robot", robot->second});
        }
    }
    for (const auto& used : server.usedServers()) {
        const auto found = known.servers.find(used.name);
        if (found != known.servers.end()) {
            command.insert(command.end(), {"--use", used.name + "=" + found->second});
        }
    }
}

/// Options of `metier serve` for the virtual controllers of a server's devices.
void addControllers(const cell::ServerConfig& server, const CellAddresses& known,
                    std::vector<std::string>& command) {
    const auto give = [&](const cell::DriverChoice& driver, const char* option) {
        const auto found = known.controllers.find(driver.controller);
        if (found != known.controllers.end()) {
            command.insert(command.end(), {option, found->second});
        }
    };
    if (const auto* driver = server.driver()) {
        give(*driver, "--controller");
    }
    const auto* arm = server.as<cell::ArmServer>();
    if (arm != nullptr && arm->force_torque_sensor) {
        give(*arm->force_torque_sensor, "--sensor");
    }
}

}  // namespace

CellRank rankOf(const cell::ServerConfig& server) {
    return std::visit(
        overloaded{[](const cell::ArmServer&) { return CellRank::device; },
                   [](const cell::GripperServer&) { return CellRank::device; },
                   [](const cell::MoveComponent&) { return CellRank::move; },
                   [](const cell::SynchronizedServer&) { return CellRank::synchronized; },
                   [](const cell::CompositionServer&) { return CellRank::composition; }},
        server.kind);
}

CellMember::Plan planOf(const cell::CellConfig& cell,
                        const cell::VirtualController& controller, Ports ports,
                        const CellAddresses& known) {
    const auto* world = cell.world();
    CellMember::Plan plan{controller.name,
                          world == &controller ? CellRank::world : CellRank::controller,
                          {self(), "virtual", "run", cell.file.string(), controller.name},
                          {}};
    if (ports == Ports::free) {
        plan.command.insert(plan.command.end(), {"--address", freeAddress()});
    }
    if (world != nullptr && world != &controller) {
        plan.command.insert(plan.command.end(), {"--world", known.controllers.at(world->name)});
    }
    return plan;
}

CellMember::Plan planOf(const cell::CellConfig& cell,
                        const cell::ServerConfig& server, Ports ports,
                        const CellAddresses& known) {
    CellMember::Plan plan{server.name, rankOf(server), {self()}, {}};
    const auto security = securityArguments();
    plan.command.insert(plan.command.end(), security.begin(), security.end());
    plan.command.insert(plan.command.end(),
                        {"serve", cell.file.string(), "--server", server.name, "--lab-is-known"});
    if (ports == Ports::free) {
        plan.command.insert(plan.command.end(), {"--port", "0", "--metrics", "off"});
    }
    if (ports == Ports::free || server.port == 0) {
        plan.option_for_port = "--again-at";
    }
    addUsed(server, known, plan.command);
    addControllers(server, known, plan.command);
    return plan;
}

}  // namespace metier::app
