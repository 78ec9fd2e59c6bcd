#include "servers.hpp"

#include <fmt/format.h>

#include <utility>

#include "metier/cell/cell.hpp"

namespace metier::app {

void addServerChoice(CLI::App& command, ServerChoice& choice) {
    command.add_option("url", choice.urls, "Addresses of servers: opc.tcp://host:port");
    command.add_option("--cell", choice.cell, "Take the servers of this cell file");
}

Result<std::vector<std::string>> addressesOf(const ServerChoice& choice) {
    auto urls = choice.urls;
    if (!choice.cell.empty()) {
        METIER_ASSIGN(const auto cell, cell::loadCell(choice.cell));
        for (const auto& server : cell.servers) {
            urls.push_back(fmt::format("opc.tcp://{}:{}", server.address, server.port));
        }
    }
    if (urls.empty()) {
        return fail(Errc::invalid_argument, "name a server, or a cell with --cell FILE");
    }
    return urls;
}

SteadyTime deadlineIn(double seconds) {
    return std::chrono::steady_clock::now() + std::chrono::duration_cast<std::chrono::nanoseconds>(
                                                  std::chrono::duration<double>(seconds));
}

Result<std::unique_ptr<opcua::Client>> connectTo(const CommandIdentity& identity,
                                                 const std::string& url, OnLoss on_loss) {
    opcua::ClientOptions options;
    options.application_name = "metier command";
    options.publishing_interval = std::chrono::milliseconds(20);
    if (on_loss == OnLoss::reconnect) {
        options.reconnect.emplace();
    }
    if (const auto secured = identity.secure(options, url); !secured) {
        return fail(secured.error().code, fmt::format("{}: {}", url, secured.error().message));
    }
    auto client = opcua::Client::connect(url, options);
    if (!client) {
        return fail(client.error().code, fmt::format("{}: {}{}", url, client.error().message,
                                                     identity.adviceOn(client.error())));
    }
    identity.noteConnected(options, url);
    return std::move(*client);
}

void showConnection(opcua::Client& client) {
    client.onConnectionChange(
        [](const opcua::ConnectionChange& change) { fmt::print(stderr, "{}\n", textOf(change)); });
}

std::string textOf(const opcua::ConnectionChange& change) {
    using Kind = opcua::ConnectionChange::Kind;
    switch (change.kind) {
        case Kind::lost:
            return fmt::format("connection lost: {}; reconnecting", change.why.message);
        case Kind::back:
            return fmt::format("connection back; server restarted: {}",
                               change.server_restarted ? "yes" : "no");
        case Kind::given_up:
            return fmt::format("connection given up: {}", change.why.message);
    }
    return {};
}

Exit reportOutcome(const opcua::Failure& failure) {
    report(failure);
    if (failure.code == Errc::execution_lost) {
        return Exit::execution_lost;
    }
    return failure.delivery == opcua::Failure::Delivery::unknown ? Exit::unknown : Exit::failed;
}

void addSkillChoice(CLI::App& command, SkillChoice& choice) {
    command.add_option("url", choice.url, "Address of the server: opc.tcp://host:port")->required();
    command
        .add_option("skill", choice.skill,
                    "Name of the skill, or Controller/Name if several have it")
        ->required();
}

bool isAddress(const std::string& text) {
    return text.starts_with("opc.tcp://");
}

Result<OpenSkill> openSkill(const CommandIdentity& identity, const SkillChoice& choice,
                            OnLoss on_loss) {
    METIER_ASSIGN(auto client, connectTo(identity, choice.url, on_loss));
    METIER_ASSIGN(auto address, client::findSkill(*client, choice.skill));
    METIER_ASSIGN(auto skill, client::SkillHandle::open(*client, std::move(address)));
    return OpenSkill{std::move(client), std::move(skill)};
}

}  // namespace metier::app
