#include <fmt/format.h>

#include <chrono>
#include <cstdint>
#include <cstdio>
#include <memory>
#include <string>

#include "folders.hpp"
#include "metier/opcua/server.hpp"
#include "metier/link/stop_signal.hpp"
#include "ready_line.hpp"
#include "security_options.hpp"
#include "server_access.hpp"

namespace metier::app {
namespace {

constexpr std::uint32_t kLongest = 86'400;  // to remember a server [s]

struct DiscoveryOptions {
    std::uint16_t port = 4840;  // as OPC 10000-12 has it
    std::string address = "127.0.0.1";
    std::uint32_t forget_after = 75;  // s
};

Exit runDiscovery(const DiscoveryOptions& options, const Security& security) {
    const link::StopSignal stop;
    opcua::ServerOptions server_options;
    server_options.application_name = "metier discovery";
    server_options.port = options.port;
    server_options.bind_addresses = {options.address};
    server_options.discovery =
        opcua::DiscoveryService{.forget_after = std::chrono::seconds(options.forget_after)};
    const auto identity = Identity::create(
        security, options.port == 0 ? "discovery" : fmt::format("discovery-{}", options.port),
        {.application_name = "metier discovery",
         .application_uri = fmt::format("urn:{}:metier:discovery:{}", hostName(), options.port),
         .hosts = {hostName(), options.address}});
    if (!identity) {
        return report(identity.error());
    }
    const SystemClock clock;
    server_options.application_uri = "urn:metier:discovery";
    const auto access = secureServer(server_options, *identity, clock);
    if (!access) {
        return report(access.error());
    }
    const auto server = opcua::Server::create(std::move(server_options));
    if (!server) {
        return reportUsage(server.error());
    }
    if (*access != nullptr) {
        (*access)->follow(**server);
    }
    if (const auto started = (*server)->start(); !started) {
        return report(started.error());
    }
    if (*access == nullptr) {
        security.noteServedOpen((*server)->endpointUrl());
    }
    warnOfLab(security, "metier discovery", (*server)->endpointUrl());
    fmt::print("{}\n", readyLine((*server)->endpointUrl()));
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
    command->add_option("--port", options->port, "TCP port; 0: a free one")->capture_default_str();
    command->add_option("--address", options->address, "Loopback address to listen on")
        ->capture_default_str();
    command
        ->add_option("--forget-after", options->forget_after,
                     "Forget servers that did not renew for so long [s]")
        ->check(CLI::Range(1U, kLongest))
        ->capture_default_str();
    command->callback(
        [options, &context] { context.exit = runDiscovery(*options, context.security); });
}

}  // namespace metier::app
