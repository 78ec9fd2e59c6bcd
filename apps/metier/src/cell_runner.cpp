#include "cell_runner.hpp"

#include <fmt/format.h>
#include <poll.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <random>

#include "ready_line.hpp"
#include "security.hpp"

namespace metier::app {
namespace {

using namespace std::chrono_literals;
using configuration::ServerKind;

constexpr auto kReadyTimeout = 30s;

std::string self() {
    return std::filesystem::read_symlink("/proc/self/exe").string();
}

/// The driver of a server's device; nullptr for one without.
const configuration::DriverChoice* driverOf(const configuration::ServerConfig& server) {
    switch (server.kind) {
        case ServerKind::arm:
            return &server.arm.driver;
        case ServerKind::gripper:
            return &server.gripper.driver;
        case ServerKind::move:
        case ServerKind::composition:
        case ServerKind::synchronized:
            break;
    }
    return nullptr;
}

/// Some address of this machine that nobody else is likely to use.
std::string freeAddress() {
    std::random_device random;
    const auto part = [&random](unsigned low, unsigned high) {
        return std::uniform_int_distribution<unsigned>(low, high)(random);
    };
    return fmt::format("127.{}.{}.{}", part(1, 254), part(0, 255), part(1, 254));
}

}  // namespace

Result<CellRunner> CellRunner::start(const configuration::CellConfig& cell, Ports ports,
                                     const OnReady& on_ready) {
    CellRunner runner;
    for (const bool world : {true, false}) {
        for (const auto& controller : cell.virtual_controllers) {
            if ((&controller == cell.world()) != world) {
                continue;
            }
            if (auto started = runner.startVirtual(cell, controller, ports); !started) {
                return fail(started.error());
            }
        }
    }
    for (const auto kind : {ServerKind::arm, ServerKind::gripper, ServerKind::move,
                            ServerKind::synchronized, ServerKind::composition}) {
        for (const auto& server : cell.servers) {
            if (server.kind != kind) {
                continue;
            }
            if (auto started = runner.startServer(cell, server, ports); !started) {
                return fail(started.error());
            }
            on_ready(runner.running_.back());
        }
    }
    return runner;
}

Result<void> CellRunner::startVirtual(const configuration::CellConfig& cell,
                                      const configuration::VirtualController& controller,
                                      Ports ports) {
    std::vector<std::string> command{self(), "virtual", "run", cell.file.string(), controller.name};
    if (ports == Ports::free) {
        command.insert(command.end(), {"--address", freeAddress()});
    }
    const auto* world = cell.world();
    if (world != nullptr && world != &controller) {
        command.insert(command.end(), {"--world", virtual_addresses_.at(world->name)});
    }
    auto address = startChild(controller.name, command);
    if (!address) {
        return fail(address.error());
    }
    virtual_addresses_.emplace(controller.name, std::move(*address));
    return {};
}

Result<void> CellRunner::startServer(const configuration::CellConfig& cell,
                                     const configuration::ServerConfig& server, Ports ports) {
    std::vector<std::string> command{self(), "serve", cell.file.string(), "--server", server.name};
    const auto security = securityArguments();
    command.insert(command.begin() + 1, security.begin(), security.end());
    if (ports == Ports::free) {
        command.insert(command.end(), {"--port", "0", "--metrics", "off"});
    }
    const auto robot = std::find_if(running_.begin(), running_.end(), [&](const Running& other) {
        return other.name == server.move.robot;
    });
    if (server.kind == ServerKind::move && robot != running_.end()) {
        command.insert(command.end(), {"--robot", robot->url});
    }
    for (const auto& used : server.usedServers()) {
        for (const auto& other : running_) {
            if (other.name == used.name) {
                command.insert(command.end(), {"--use", used.name + "=" + other.url});
            }
        }
    }
    const auto give = [&](const configuration::DriverChoice& driver, const char* option) {
        const auto found = virtual_addresses_.find(driver.controller);
        if (found != virtual_addresses_.end()) {
            command.insert(command.end(), {option, found->second});
        }
    };
    if (const auto* driver = driverOf(server)) {
        give(*driver, "--controller");
    }
    if (server.arm.force_torque_sensor) {
        give(*server.arm.force_torque_sensor, "--sensor");
    }
    auto url = startChild(server.name, command);
    if (!url) {
        return fail(url.error());
    }
    running_.push_back({server.name, std::move(*url)});
    return {};
}

Result<std::string> CellRunner::startChild(const std::string& name,
                                           const std::vector<std::string>& command) {
    auto child = process::ChildProcess::start(command);
    if (!child) {
        return fail(child.error());
    }
    const auto line = child->readLine(std::chrono::steady_clock::now() + kReadyTimeout);
    if (!line) {
        return fail(line.error().code,
                    fmt::format("'{}' did not become ready: {}", name, line.error().message));
    }
    auto address = addressOfReadyLine(*line);
    if (!address) {
        return fail(Errc::internal, fmt::format("'{}' said: {}", name, *line));
    }
    names_.push_back(name);
    processes_.push_back(std::move(*child));
    return std::move(*address);
}

std::optional<CellRunner::Ended> CellRunner::waitForEnd(int wake_descriptor) {
    std::vector<pollfd> requests{{wake_descriptor, POLLIN, 0}};
    for (const auto& process : processes_) {
        requests.push_back({process.outputDescriptor(), POLLIN, 0});
    }
    // A server prints nothing after its ready line: its output becomes readable when it ends.
    while (poll(requests.data(), requests.size(), -1) < 0 && errno == EINTR) {
    }
    for (std::size_t i = 0; i < processes_.size(); ++i) {
        if (requests[i + 1].revents != 0) {
            const auto status =
                processes_[i].waitUntil(std::chrono::steady_clock::now() + kReadyTimeout);
            return Ended{names_[i], status.value_or(-1)};
        }
    }
    return std::nullopt;
}

}  // namespace metier::app
