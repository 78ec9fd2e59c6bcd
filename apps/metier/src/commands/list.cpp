#include <fmt/format.h>

#include <memory>
#include <nlohmann/json.hpp>
#include <utility>
#include <vector>

#include "metier/client/lack.hpp"
#include "metier/client/skill_finder.hpp"
#include "metier/client/skill_handle.hpp"
#include "metier/opcua/text.hpp"
#include "printable.hpp"
#include "servers.hpp"

namespace metier::app {
namespace {

struct ListOptions {
    ServerChoice servers;
    bool json = false;
};

struct ListedSkill {
    std::string controller;
    std::string name;
    std::string type;
    std::string state;
    std::vector<client::Lack> lacks;
};

Result<std::vector<ListedSkill>> listSkills(const CommandIdentity& identity,
                                            const std::string& url) {
    METIER_ASSIGN(const auto client, connectTo(identity, url));
    METIER_ASSIGN(const auto skills, client::findSkills(*client));
    std::vector<ListedSkill> listed;
    for (const auto& skill : skills) {
        const auto state = client->translate(skill.node, {{0, "CurrentState"}});
        const auto value = state ? client->read(*state) : opcua::Answer<opcua::Value>();
        const auto text =
            value ? value->as<opcua::LocalizedText>() : Result<opcua::LocalizedText>();
        METIER_ASSIGN(auto lacks, client::readLacks(*client, skill));
        listed.push_back({skill.controllerName(), skill.name, skill.type_name,
                          text ? opcua::sanitise(text->text) : "unknown", std::move(lacks)});
    }
    return listed;
}

void print(const std::string& url, const std::vector<ListedSkill>& skills) {
    fmt::print("{}\n", url);
    for (const auto& skill : skills) {
        const auto lacks = textOf(skill.lacks);
        fmt::print("  {:<18} {:<28} {}{}{}\n", skill.controller, skill.name, skill.state,
                   lacks.empty() ? "" : "  ", lacks);
    }
    if (skills.empty()) {
        fmt::print("  no skills\n");
    }
}

std::vector<std::string_view> namesOf(const std::vector<client::Lack>& lacks) {
    std::vector<std::string_view> names;
    for (const auto lack : lacks) {
        names.push_back(toString(lack));
    }
    return names;
}

nlohmann::json jsonOf(const std::string& url, const std::vector<ListedSkill>& skills) {
    auto list = nlohmann::json::array();
    for (const auto& skill : skills) {
        list.push_back({{"controller", skill.controller},
                        {"skill", skill.name},
                        {"type", skill.type},
                        {"state", skill.state},
                        {"lacks", namesOf(skill.lacks)}});
    }
    return {{"url", url}, {"skills", list}};
}

/// Lists the skills of all servers. A server that does not answer is reported, and the others are
/// listed all the same.
Result<Exit> runList(const ListOptions& options, const CommandIdentity& identity) {
    METIER_ASSIGN(const auto urls, addressesOf(options.servers));
    auto exit = Exit::success;
    auto json = nlohmann::json::array();
    for (const auto& url : urls) {
        const auto skills = listSkills(identity, url);
        if (!skills) {
            exit = report(skills.error());
            json.push_back({{"url", url}, {"error", printable(skills.error().message)}});
        } else if (options.json) {
            json.push_back(jsonOf(url, *skills));
        } else {
            print(url, *skills);
        }
    }
    if (options.json) {
        fmt::print("{}\n", json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace));
    }
    return exit;
}

}  // namespace

void addList(CLI::App& app, CommandContext& context) {
    // Shared by CLI11, which fills it, and the callback, which reads it.
    auto options = std::make_shared<ListOptions>();
    auto* command = app.add_subcommand("list", "List servers, their skills and the skills' states");
    addServerChoice(*command, options->servers);
    addServerSearch(*command, options->servers);
    command->add_flag("--json", options->json, "Print JSON");
    command->callback(
        [options, &context] { context.exit = exitOf(runList(*options, context.identity)); });
}

}  // namespace metier::app
