#include "server_search.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <iterator>
#include <utility>

#include "metier/cell/cell.hpp"
#include "printable.hpp"

namespace metier::app {
namespace {

using opcua::FoundServer;

// Address of a machine's discovery server, by OPC 10000-12.
constexpr const char* kLocalDiscovery = "opc.tcp://127.0.0.1:4840";
// Cell file of the current folder.
constexpr const char* kCellHere = "cell.toml";

Result<std::vector<FoundServer>> serversOfCell(const std::string& file) {
    METIER_ASSIGN(const auto cell, cell::loadCell(file));
    std::vector<FoundServer> servers;
    for (const auto& server : cell.servers) {
        servers.push_back(
            {fmt::format("opc.tcp://{}:{}", server.address, server.port), server.name, file});
    }
    return servers;
}

std::string whyNone(const opcua::Sighting& sighting) {
    std::string why = fmt::format(
        "no server found: name one, or a cell with --cell FILE; there is no {} here", kCellHere);
    for (const auto& problem : sighting.problems) {
        why += "; " + problem.message;
    }
    return why;
}

/// Prints on whom a command goes that named nobody.
void show(const std::vector<FoundServer>& servers) {
    for (const auto& server : servers) {
        fmt::print(stderr, "found {} {} ({})\n", server.url, printable(server.name),
                   printable(server.reported_by));
    }
}

Result<std::vector<FoundServer>> find(const std::vector<std::string>& discovery) {
    std::error_code unreadable;  // then there is no such file for us
    if (discovery.empty() && std::filesystem::exists(kCellHere, unreadable)) {
        METIER_ASSIGN(auto servers, serversOfCell(kCellHere));
        show(servers);
        return servers;
    }
    auto sighting = searchFor(discovery);
    if (sighting.servers.empty()) {
        return fail(Errc::not_found, whyNone(sighting));
    }
    show(sighting.servers);
    return std::move(sighting.servers);
}

}  // namespace

void addServerChoice(CLI::App& command, ServerChoice& choice) {
    command.add_option("url", choice.urls, "Addresses of servers: opc.tcp://host:port");
    command.add_option("--cell", choice.cell, "Take the servers of this cell file");
}

void addServerSearch(CLI::App& command, ServerChoice& choice) {
    command.add_option("--discovery", choice.discovery,
                       "Take the servers that these discovery servers know. Without any address: "
                       "those of ./cell.toml, or else of this machine's discovery server and mDNS");
}

opcua::Sighting searchFor(std::vector<std::string> discovery) {
    const auto mdns = discovery.empty() ? opcua::Mdns::asked : opcua::Mdns::left_out;
    if (discovery.empty()) {
        discovery.emplace_back(kLocalDiscovery);
    }
    return opcua::searchServers(discovery, mdns);
}

Result<std::vector<FoundServer>> serversOf(const ServerChoice& choice) {
    std::vector<FoundServer> servers;
    for (const auto& url : choice.urls) {
        servers.push_back({url, "", "command line"});
    }
    if (!choice.cell.empty()) {
        METIER_ASSIGN(auto of_cell, asUsage(serversOfCell(choice.cell)));
        servers.insert(servers.end(), std::make_move_iterator(of_cell.begin()),
                       std::make_move_iterator(of_cell.end()));
    }
    return servers.empty() ? find(choice.discovery) : Result<decltype(servers)>(servers);
}

Result<std::vector<std::string>> addressesOf(const ServerChoice& choice) {
    METIER_ASSIGN(const auto servers, serversOf(choice));
    std::vector<std::string> urls;
    for (const auto& server : servers) {
        urls.push_back(server.url);
    }
    return urls;
}

}  // namespace metier::app
