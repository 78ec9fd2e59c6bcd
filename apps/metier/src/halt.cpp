#include <fmt/format.h>

#include <memory>

#include "metier/skill_client/skill_handle.hpp"
#include "servers.hpp"

namespace metier::app {
namespace {

struct HaltOptions {
    ServerChoice servers;
    std::string skill;
};

/// Calls Halt of one skill. A skill that is Halted already is as it should be.
Result<void> haltOne(opcua::Client& client, const skill_client::SkillAddress& skill) {
    const auto method = client.translate(skill.node, {{0, "Halt"}});
    if (!method) {
        return fail(method.error());
    }
    const auto called = client.call(skill.node, *method);
    if (!called && called.error().status != opcua::status::kBadInvalidState) {
        return fail(called.error());
    }
    fmt::print("{:<28} {}\n", skill.name, called ? "halted" : "is halted");
    return {};
}

Result<void> haltServer(const std::string& url, const std::string& name) {
    auto client = connectTo(url);
    if (!client) {
        return fail(client.error());
    }
    const auto skills = skill_client::findSkills(**client);
    if (!skills) {
        return fail(skills.error());
    }
    Result<void> outcome;
    for (const auto& skill : *skills) {
        if (!name.empty() && skill.name != name) {
            continue;
        }
        // One refusal does not keep the others from being halted.
        if (auto halted = haltOne(**client, skill); !halted) {
            outcome = std::move(halted);
        }
    }
    return outcome;
}

Exit runHalt(const HaltOptions& options) {
    const auto urls = addressesOf(options.servers);
    if (!urls) {
        return reportUsage(urls.error());
    }
    auto exit = Exit::success;
    for (const auto& url : *urls) {
        if (const auto halted = haltServer(url, options.skill); !halted) {
            exit = report(halted.error());
        }
    }
    return exit;
}

}  // namespace

void addHalt(CLI::App& app, Exit& exit) {
    // Shared by CLI11, which fills it, and the callback, which reads it.
    auto options = std::make_shared<HaltOptions>();
    auto* command = app.add_subcommand(
        "halt", "Halt every skill of some servers. This is not an emergency stop");
    addServerChoice(*command, options->servers);
    command->add_option("--skill", options->skill, "Only the skill of this name");
    command->callback([options, &exit] { exit = runHalt(*options); });
}

}  // namespace metier::app
