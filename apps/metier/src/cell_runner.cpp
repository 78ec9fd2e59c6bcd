#include "cell_runner.hpp"

#include <fmt/format.h>
#include <poll.h>

#include <algorithm>
#include <array>
#include <cerrno>

#include "ready_line.hpp"

namespace metier::app {
namespace {

using namespace std::chrono_literals;
using configuration::ServerKind;

constexpr auto kReadyTimeout = 30s;

std::vector<std::string> serveCommand(const configuration::CellConfig& cell,
                                      const configuration::ServerConfig& server) {
    const auto self = std::filesystem::read_symlink("/proc/self/exe");
    return {self.string(), "serve", cell.file.string(), "--server", server.name};
}

}  // namespace

Result<CellRunner> CellRunner::start(const configuration::CellConfig& cell, Ports ports,
                                     const OnReady& on_ready) {
    CellRunner runner;
    for (const auto kind : {ServerKind::arm, ServerKind::move}) {
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

Result<void> CellRunner::startServer(const configuration::CellConfig& cell,
                                     const configuration::ServerConfig& server, Ports ports) {
    auto command = serveCommand(cell, server);
    if (ports == Ports::free) {
        command.insert(command.end(), {"--port", "0"});
    }
    const auto robot = std::find_if(running_.begin(), running_.end(), [&](const Running& other) {
        return other.name == server.move.robot;
    });
    if (server.kind == ServerKind::move && robot != running_.end()) {
        command.insert(command.end(), {"--robot", robot->url});
    }
    auto child = process::ChildProcess::start(command);
    if (!child) {
        return fail(child.error());
    }
    const auto line = child->readLine(std::chrono::steady_clock::now() + kReadyTimeout);
    if (!line) {
        return fail(line.error().code, fmt::format("server '{}' did not become ready: {}",
                                                   server.name, line.error().message));
    }
    const auto url = urlOfReadyLine(*line);
    if (!url) {
        return fail(Errc::internal, fmt::format("server '{}' said: {}", server.name, *line));
    }
    running_.push_back({server.name, *url});
    processes_.push_back(std::move(*child));
    return {};
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
            return Ended{running_[i].name, status.value_or(-1)};
        }
    }
    return std::nullopt;
}

}  // namespace metier::app
