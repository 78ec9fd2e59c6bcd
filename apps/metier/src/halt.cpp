#include <fmt/format.h>

#include <chrono>
#include <memory>
#include <utility>
#include <vector>

#include "metier/skill_client/skill_handle.hpp"
#include "servers.hpp"

namespace metier::app {
namespace {

using skill_client::SkillAddress;

struct HaltOptions {
    ServerChoice servers;
    std::string skill;
    double timeout = 20.0;
};

/// Skills of one server that have taken their Halt.
struct Halting {
    std::unique_ptr<opcua::Client> client;
    std::vector<SkillAddress> skills{};
};

void tell(const SkillAddress& skill, std::string_view what) {
    fmt::print("{:<28} {}\n", skill.name, what);
}

/// Calls Halt. \return whether it was called: a skill that is Halted already is as it should be
Result<bool> callHalt(opcua::Client& client, const SkillAddress& skill) {
    const auto method = client.translate(skill.node, {{0, "Halt"}});
    if (!method) {
        return fail(method.error());
    }
    const auto called = client.call(skill.node, *method);
    if (!called && called.error().status != opcua::status::kBadInvalidState) {
        return fail(called.error());
    }
    return called.has_value();
}

/// Calls Halt of the skills of one server, waiting for none of them.
/// \param outcome the last error, if there is any: one refusal does not keep the others from being
///                halted
Halting haltServer(const std::string& url, const std::string& name, Result<void>& outcome) {
    auto client = connectTo(url);
    if (!client) {
        outcome = fail(client.error());
        return {};
    }
    Halting halting{std::move(*client)};
    const auto skills = skill_client::findSkills(*halting.client);
    if (!skills) {
        outcome = fail(skills.error());
        return halting;
    }
    for (const auto& skill : *skills) {
        if (!name.empty() && skill.name != name) {
            continue;
        }
        if (const auto called = callHalt(*halting.client, skill); !called) {
            outcome = fail(called.error());
        } else if (*called) {
            halting.skills.push_back(skill);
        } else {
            tell(skill, "is halted");
        }
    }
    return halting;
}

/// Waits for standstill: until then the skill is Running, its sub-state Stopping.
Result<void> awaitHalted(opcua::Client& client, const SkillAddress& address,
                         const HaltOptions& options, SteadyTime deadline) {
    auto skill = skill_client::SkillHandle::open(client, address);
    if (!skill) {
        return fail(skill.error());
    }
    const auto halted = skill->awaitState(skill::State::halted, deadline);
    // Somebody may have reset it before anybody here looked.
    if (halted || (halted.error().code == Errc::timeout &&
                   skill->state().value_or(skill::State::running) != skill::State::running)) {
        tell(address, "halted");
        return {};
    }
    if (halted.error().code != Errc::timeout) {
        return fail(halted.error());
    }
    return fail(Errc::timeout,
                fmt::format("{}: still halting after {} s", address.name, options.timeout));
}

Exit runHalt(const HaltOptions& options) {
    const auto urls = addressesOf(options.servers);
    if (!urls) {
        return reportUsage(urls.error());
    }
    const auto deadline =
        std::chrono::steady_clock::now() + std::chrono::duration_cast<std::chrono::nanoseconds>(
                                               std::chrono::duration<double>(options.timeout));
    auto exit = Exit::success;
    std::vector<Halting> servers;
    for (const auto& url : *urls) {
        Result<void> outcome;
        servers.push_back(haltServer(url, options.skill, outcome));
        exit = outcome ? exit : report(outcome.error());
    }
    for (const auto& server : servers) {
        for (const auto& skill : server.skills) {
            const auto halted = awaitHalted(*server.client, skill, options, deadline);
            exit = halted ? exit : report(halted.error());
        }
    }
    return exit;
}

}  // namespace

void addHalt(CLI::App& app, Exit& exit) {
    // Shared by CLI11, which fills it, and the callback, which reads it.
    auto options = std::make_shared<HaltOptions>();
    auto* command = app.add_subcommand(
        "halt",
        "Halt every skill of some servers, and wait until all stand still. This is not an "
        "emergency stop");
    addServerChoice(*command, options->servers);
    command->add_option("--skill", options->skill, "Only the skill of this name");
    command
        ->add_option("--timeout", options->timeout,
                     "Wait so long for standstill, of all together [s]")
        ->check(CLI::Range(0.1, 3'600.0))
        ->capture_default_str();
    command->callback([options, &exit] { exit = runHalt(*options); });
}

}  // namespace metier::app
