#include "discovered_cell.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <csignal>
#include <stdexcept>

namespace metier::system_tests {
namespace {

link::ChildProcess startDiscovery(int forget_after, const std::string& port) {
    auto child = link::ChildProcess::start(metierCommand(
        {"discovery", "--port", port, "--forget-after", std::to_string(forget_after)}));
    if (!child) {
        throw std::runtime_error(child.error().message);
    }
    return std::move(*child);
}

bool contains(const std::vector<std::string>& names, const std::string& name) {
    return std::find(names.begin(), names.end(), name) != names.end();
}

}  // namespace

DiscoveryProcess::DiscoveryProcess(int forget_after, const std::string& port)
    : process_(startDiscovery(forget_after, port)) {
    const std::string ready = "ready ";
    const auto line = process_.readLine(inAMinute());
    if (!line || !line->starts_with(ready)) {
        throw std::runtime_error("no discovery server: " + (line ? *line : line.error().message));
    }
    url_ = line->substr(ready.size());
}

void DiscoveryProcess::kill() {
    process_.signal(SIGKILL);
    if (!process_.waitUntil(inAMinute())) {
        throw std::runtime_error("the discovery server does not end");
    }
}

std::vector<std::string> DiscoveryProcess::names() const {
    std::vector<std::string> names;
    const auto servers = opcua::findServers(url_);
    if (!servers) {
        throw std::runtime_error(servers.error().message);
    }
    for (const auto& server : *servers) {
        if (server.type != opcua::ApplicationType::discovery_server) {
            names.push_back(server.application_name.text);
        }
    }
    return names;
}

bool DiscoveryProcess::awaitKnown(const std::string& name) const {
    return holdsSoon([&] { return contains(names(), name); });
}

bool DiscoveryProcess::awaitForgotten(const std::string& name) const {
    return holdsSoon([&] { return !contains(names(), name); });
}

std::filesystem::path discoveredCell() {
    return std::filesystem::path(METIER_SOURCE_DIR) / "tests" / "system" / "discovered.toml";
}

ServerProcess serveDiscovered(const std::string& name, const std::string& discovery_url,
                              std::vector<std::string> more) {
    more.insert(more.end(), {"--port", "0", "--discovery", discovery_url});
    return ServerProcess(name, more, discoveredCell());
}

bool holdsSoon(const std::function<bool()>& holds) {
    const auto deadline = inAMinute();
    while (!holds()) {
        if (std::chrono::steady_clock::now() > deadline) {
            return false;
        }
    }
    return true;
}

}  // namespace metier::system_tests
