// metier dashboard: the page of a cell.
#include "metier/dashboard/dashboard.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "metier/cell/cell.hpp"
#include "metier/link/start_watch.hpp"
#include "metier/link/stop_signal.hpp"
#include "metier/opcua/search.hpp"
#include "metier/records/recorder.hpp"
#include "metier/server/foreign_records.hpp"
#include "metier/server/ready_line.hpp"
#include "recorded.hpp"
#include "robot_argument.hpp"
#include "security_options.hpp"
#include "servers.hpp"

namespace metier::app {
namespace {

namespace fs = std::filesystem;
using dashboard::Cell;
using dashboard::CellServer;
using dashboard::Dashboard;

// Longest time from the signal to the end of the process.
constexpr std::chrono::seconds kLongestPageEnd{10};

struct DashboardOptions {
    ServerChoice servers;
    std::string endpoints;
    std::vector<std::string> discovery;
    bool mdns = false;
    std::string address = "127.0.0.1";
    std::uint16_t port = 8080;
    std::string host_name;
    std::string web;
    std::string meshes;
    std::string records;
};

CellServer serverAt(const std::string& url) {
    constexpr std::string_view kScheme = "opc.tcp://";
    return {.name = url.starts_with(kScheme) ? url.substr(kScheme.size()) : url, .url = url};
}

/// A name is part of keys, which are divided by "/".
CellServer serverOf(const opcua::FoundServer& found) {
    auto server = serverAt(found.url);
    if (!found.name.empty()) {
        server.name = fmt::format("{} ({})", found.name, server.name);
    }
    std::replace(server.name.begin(), server.name.end(), '/', '_');
    return server;
}

Result<Cell> cellOf(const DashboardOptions& options) {
    Cell cell;
    if (!options.servers.cell.empty()) {
        METIER_ASSIGN(const auto config, cell::loadCell(options.servers.cell));
        METIER_ASSIGN(const auto endpoints, options.endpoints.empty()
                                                ? dashboard::Endpoints{}
                                                : dashboard::loadEndpoints(options.endpoints));
        cell = dashboard::cellFrom(config, endpoints);
    }
    for (const auto& url : options.servers.urls) {
        cell.servers.push_back(serverAt(url));
    }
    if (cell.servers.empty() && options.discovery.empty() && !options.mdns) {
        return fail(Errc::invalid_argument,
                    "name servers, a cell with --cell FILE, or who knows of them with --discovery");
    }
    return cell;
}

/// Store of the servers' records: from the command line, the cell's file, or the default of this
/// user; empty: none.
std::string recordsOf(const DashboardOptions& options, const Cell& cell) {
    const auto& said = options.records.empty() ? cell.records : options.records;
    return said.empty() ? defaultRecords() : said == "off" ? "" : said;
}

/// Records of what is started from the page at servers that record nothing; null: none are kept.
std::shared_ptr<server::ForeignRecords> foreignRecords(const std::string& store) {
    if (store.empty()) {
        return nullptr;
    }
    return std::make_shared<server::ForeignRecords>([store] {
        const auto warn = [](const std::string& problem) { spdlog::warn("{}", problem); };
        auto opened = server::openForeignStore(store, "dashboard", warn);
        if (!opened) {
            spdlog::warn("what the page starts is not recorded: {}", opened.error().message);
        }
        return opened;
    });
}

std::string urlOf(const std::string& address, std::uint16_t port) {
    const bool v6 = address.find(':') != std::string::npos;
    return fmt::format("http://{}{}{}:{}", v6 ? "[" : "", address, v6 ? "]" : "", port);
}

/// Adds servers that discovery finds, until the signal.
void watchDiscovery(Dashboard& page, const DashboardOptions& options,
                    const link::StopSignal& stop) {
    constexpr std::chrono::seconds kBetween{10};
    const auto mdns = options.mdns ? opcua::Mdns::asked : opcua::Mdns::left_out;
    while (!stop.came()) {
        const auto sighting = opcua::searchServers(options.discovery, mdns);
        for (const auto& problem : sighting.problems) {
            spdlog::debug("{}", problem.message);
        }
        for (const auto& found : sighting.servers) {
            page.addServer(serverOf(found));
        }
        if (stop.waitUntil(std::chrono::steady_clock::now() + kBetween)) {
            return;
        }
    }
}

/// Connections of the page to servers: the same as those of a command.
dashboard::Connector connectorOf(const CommandIdentity& identity) {
    return {
        .options = [&identity](const std::string& url) -> Result<opcua::ClientOptions> {
            opcua::ClientOptions client;
            client.application_name = "metier dashboard";
            METIER_TRY(identity.secure(client, url));
            return client;
        },
        .advice = [&identity](const opcua::Failure& why) { return identity.adviceOn(why); },
        .connected = [&identity](const opcua::ClientOptions& client,
                                 const std::string& url) { identity.noteConnected(client, url); }};
}

Result<Exit> runDashboard(const DashboardOptions& options, const CommandContext& context) {
    const link::StopSignal stop;
    link::StopSignal::outliveOutput();
    printLabNotice(context.security);
    auto starting = std::make_unique<link::StartWatch>(stop);
    METIER_ASSIGN(auto cell, asUsage(cellOf(options)));
    auto records = recordsOf(options, cell);
    auto connector = connectorOf(context.identity);
    connector.foreign_records = foreignRecords(records);
    METIER_ASSIGN(auto models, loadAllRobots());
    const SystemClock clock;
    auto started = Dashboard::start(
        {.cell = std::move(cell),
         .connector = std::move(connector),
         .lab = context.security.insecure_lab,
         .address = options.address,
         .port = options.port,
         .host_name = options.host_name,
         .web = options.web.empty() ? sharedFolder("web", METIER_WEB_DIR) : fs::path(options.web),
         .meshes = options.meshes,
         .records = std::move(records),
         .models = std::move(models)},
        clock);
    starting.reset();
    METIER_ASSIGN(const auto page, std::move(started));
    fmt::print("{}\n", server::readyLine(urlOf(options.address, page->port())));
    std::fflush(stdout);
    if (options.discovery.empty() && !options.mdns) {
        stop.wait();
    } else {
        watchDiscovery(*page, options, stop);
    }
    link::StopSignal::endWithin(kLongestPageEnd);
    return Exit::success;
}

void addHttpOptions(CLI::App& command, DashboardOptions& options) {
    command
        .add_option("--address", options.address, "Address of this machine to serve the page at")
        ->capture_default_str();
    command.add_option("--port", options.port, "TCP port of the page; 0: a free one")
        ->capture_default_str();
    command.add_option("--host-name", options.host_name,
                       "Name by which people reach the page, besides addresses and localhost");
    command.add_option("--web", options.web, "Folder with the files of the page")
        ->check(CLI::ExistingDirectory);
    command
        .add_option("--meshes", options.meshes,
                    "Folder with URDF files and meshes of your own, to draw arms with")
        ->check(CLI::ExistingDirectory);
}

}  // namespace

void addDashboard(CLI::App& app, CommandContext& context) {
    // Shared by CLI11, which fills it, and the callback, which reads it.
    auto options = std::make_shared<DashboardOptions>();
    auto* command = app.add_subcommand(
        "dashboard", "Serve a page to watch and drive servers with a browser, until Ctrl-C");
    addServerChoice(*command, options->servers);
    command->add_option("--endpoints", options->endpoints,
                        "Take the addresses of the cell from this file of `metier up --endpoints`");
    command->add_option("--discovery", options->discovery,
                        "Also show the servers that these discovery servers know");
    command->add_flag("--mdns", options->mdns, "Also show the servers that mDNS finds");
    command
        ->add_option("--records", options->records,
                     "Where servers record what they execute, and this page what it starts at "
                     "servers that record nothing: a file, sqlite:FILE, postgresql://..., or off "
                     "[as the cell's file says, else records.db in "
                     "~/.local/state/metier]")
        ->check(withoutPassword());
    addHttpOptions(*command, *options);
    command->callback(
        [options, &context] { context.exit = exitOf(runDashboard(*options, context)); });
}

}  // namespace metier::app
