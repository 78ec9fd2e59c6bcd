#include "cell_commands.hpp"

#include <fmt/format.h>

#include <filesystem>

#include "metier/base/random.hpp"
#include "security_options.hpp"

namespace metier::app {
namespace {

std::string self() {
    return std::filesystem::read_symlink("/proc/self/exe").string();
}

/// Random address of this machine that is hardly used by others.
std::string freeAddress() {
    const auto part = [](std::uint64_t low, std::uint64_t high) {
        return low + randomNumber() % (high - low + 1);
    };
    return fmt::format("127.{}.{}.{}", part(1, 254), part(0, 255), part(1, 254));
}

/// Options of `metier serve` for the servers that a server uses.
void addUsed(const cell::ServerConfig& server, const server::CellAddresses& known,
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
void addControllers(const cell::ServerConfig& server, const server::CellAddresses& known,
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

MetierCommands::MetierCommands(const cell::CellConfig& cell, Ports ports,
                               const server::Security& security)
    : cell_(cell), ports_(ports), security_(securityArguments(security)) {}

server::CellCommand MetierCommands::of(const cell::VirtualController& controller,
                                       const server::CellAddresses& known) const {
    const auto* world = cell_.world();
    server::CellCommand command{{self(), "virtual", "run", cell_.file.string(), controller.name}};
    auto& words = command.words;
    if (ports_ == Ports::free) {
        words.insert(words.end(), {"--address", freeAddress()});
    }
    if (world != nullptr && world->name != controller.name) {
        words.insert(words.end(), {"--world", known.controllers.at(world->name)});
    }
    return command;
}

server::CellCommand MetierCommands::of(const cell::ServerConfig& server,
                                       const server::CellAddresses& known) const {
    server::CellCommand command{{self()}};
    auto& words = command.words;
    words.insert(words.end(), security_.begin(), security_.end());
    words.insert(words.end(),
                 {"serve", cell_.file.string(), "--server", server.name, "--lab-is-known"});
    if (ports_ == Ports::free) {
        words.insert(words.end(), {"--port", "0", "--metrics", "off"});
    }
    if (ports_ == Ports::free || server.port == 0) {
        command.option_for_port = "--again-at";
    }
    addUsed(server, known, words);
    addControllers(server, known, words);
    return command;
}

}  // namespace metier::app
