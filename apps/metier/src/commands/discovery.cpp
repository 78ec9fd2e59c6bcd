#include <fmt/format.h>

#include <chrono>
#include <cstdint>
#include <cstdio>
#include <memory>

#include "metier/link/stop_signal.hpp"
#include "metier/server/discovery_server.hpp"
#include "metier/server/ready_line.hpp"
#include "security_options.hpp"

namespace metier::app {
namespace {

constexpr std::uint32_t kLongest = 86'400;  // longest time for which a server is remembered [s]

struct DiscoveryOptions {
    server::DiscoveryServer::Options server;
    std::uint32_t forget_after = 75;  // s
};

server::DiscoveryServer::Options serverOf(const DiscoveryOptions& options) {
    auto server = options.server;
    server.forget_after = std::chrono::seconds(options.forget_after);
    return server;
}

Result<Exit> runDiscovery(const DiscoveryOptions& options, const server::Security& security) {
    const link::StopSignal stop;
    const auto server_options = serverOf(options);
    METIER_ASSIGN(const auto identity, server::identityOf(server_options, security));
    METIER_ASSIGN(const auto server, server::DiscoveryServer::start(server_options, identity));
    warnOfLab(security, "metier discovery", server->url());
    fmt::print("{}\n", server::readyLine(server->url()));
    std::fflush(stdout);
    stop.wait();
    return Exit::success;
}

}  // namespace

void addDiscovery(CLI::App& app, CommandContext& context) {
    // Shared by CLI11, which fills it, and the callback, which reads it.
    auto options = std::make_shared<DiscoveryOptions>();
    auto* command = app.add_subcommand(
        "discovery", "Run a Local Discovery Server, until Ctrl-C; prints 'ready URL'");
    command->add_option("--port", options->server.port, "TCP port; 0: a free one")
        ->capture_default_str();
    command->add_option("--address", options->server.address, "Loopback address to listen on")
        ->capture_default_str();
    within(command->add_option("--forget-after", options->forget_after,
                               "Forget servers that did not renew for so long [s]"),
           1U, kLongest);
    command->callback(
        [options, &context] { context.exit = exitOf(runDiscovery(*options, context.security)); });
}

}  // namespace metier::app
