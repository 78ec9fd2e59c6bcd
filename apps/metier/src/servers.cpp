#include "servers.hpp"

#include <fmt/format.h>

#include "metier/configuration/cell.hpp"

namespace metier::app {

void addServerChoice(CLI::App& command, ServerChoice& choice) {
    command.add_option("url", choice.urls, "Addresses of servers: opc.tcp://host:port");
    command.add_option("--cell", choice.cell, "Take the servers of this cell file");
}

Result<std::vector<std::string>> addressesOf(const ServerChoice& choice) {
    auto urls = choice.urls;
    if (!choice.cell.empty()) {
        const auto cell = configuration::loadCell(choice.cell);
        if (!cell) {
            return fail(cell.error());
        }
        for (const auto& server : cell->servers) {
            urls.push_back(fmt::format("opc.tcp://{}:{}", server.address, server.port));
        }
    }
    if (urls.empty()) {
        return fail(Errc::invalid_argument, "name a server, or a cell with --cell FILE");
    }
    return urls;
}

Result<std::unique_ptr<opcua::Client>> connectTo(const std::string& url) {
    opcua::ClientOptions options;
    options.application_name = "metier command";
    options.publishing_interval = std::chrono::milliseconds(20);
    auto client = opcua::Client::connect(url, options);
    if (!client) {
        return fail(client.error().code, fmt::format("{}: {}", url, client.error().message));
    }
    return std::move(*client);
}

}  // namespace metier::app
