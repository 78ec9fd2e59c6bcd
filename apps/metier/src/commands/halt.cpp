#include <fmt/format.h>

#include <future>
#include <string>
#include <vector>

#include "metier/client/skill_handle.hpp"
#include "servers.hpp"

namespace metier::app {
namespace {

using client::SkillAddress;

struct HaltOptions {
    ServerChoice servers;
    std::string skill;
    double timeout = 20.0;
};

void tell(const SkillAddress& skill, std::string_view what) {
    fmt::print("{:<28} {}\n", skill.name, what);
}

/// Calls Halt. \return whether it was called: a skill that is Halted already is as it should be
Result<bool> callHalt(opcua::Client& client, const SkillAddress& skill) {
    const auto method = client::findMethod(client, skill, skill::Method::halt);
    if (!method && method.error().status == opcua::status::kBadNoMatch) {
        return fail(Errc::not_supported, skill.name + " has no Halt");
    }
    METIER_TRY(method);
    const auto called = client.call(skill.node, *method);
    if (!called && called.error().status != opcua::status::kBadInvalidState) {
        return fail(called.error());
    }
    return called.has_value();
}

/// Waits for standstill: until then the skill is Running, its sub-state Stopping.
Result<void> awaitHalted(opcua::Client& client, const SkillAddress& address,
                         const HaltOptions& options, SteadyTime deadline) {
    METIER_ASSIGN(auto skill, client::SkillHandle::open(client, address));
    const auto stands = skill.awaitRest(deadline);
    if (!stands && stands.error().code == Errc::timeout) {
        return fail(Errc::timeout,
                    fmt::format("{}: still halting after {} s", address.name, options.timeout));
    }
    if (!stands) {
        return fail(stands.error());
    }
    tell(address, "halted");  // even if a client has reset it since
    return {};
}

/// Halts the skills of one server, all of them before it waits for any.
class Halting {
public:
    Halting(const HaltOptions& options, const CommandIdentity& identity, SteadyTime deadline)
        : options_(options), identity_(identity), deadline_(deadline) {}

    Result<Exit> halt(const std::string& url) {
        METIER_ASSIGN(const auto client, connectTo(identity_, url));
        METIER_ASSIGN(const auto skills, client::findSkills(*client));
        for (const auto& skill : skills) {
            if (options_.skill.empty() || skill.name == options_.skill) {
                call(*client, skill);
            }
        }
        for (const auto& skill : called_) {
            note(awaitHalted(*client, skill, options_, deadline_));
        }
        return exit_;
    }

private:
    void call(opcua::Client& client, const SkillAddress& skill) {
        const auto called = callHalt(client, skill);
        if (!called) {
            note(fail(called.error()));
        } else if (*called) {
            called_.push_back(skill);
        } else {
            tell(skill, "is halted");
        }
    }

    /// One refusal does not keep the others from being halted.
    void note(const Result<void>& outcome) { exit_ = outcome ? exit_ : report(outcome.error()); }

    const HaltOptions& options_;
    const CommandIdentity& identity_;
    const SteadyTime deadline_;
    std::vector<SkillAddress> called_;
    Exit exit_ = Exit::success;
};

/// All servers at the same time: one that does not answer delays none.
Result<Exit> runHalt(const HaltOptions& options, const CommandIdentity& identity) {
    METIER_ASSIGN(const auto urls, addressesOf(options.servers));
    const auto deadline = deadlineIn(options.timeout);
    std::vector<std::future<Exit>> servers;
    for (const auto& url : urls) {
        servers.push_back(std::async(std::launch::async, [&, deadline] {
            return exitOf(Halting(options, identity, deadline).halt(url));
        }));
    }
    auto exit = Exit::success;
    for (auto& server : servers) {
        const auto ended = server.get();
        exit = ended == Exit::success ? exit : ended;
    }
    return exit;
}

}  // namespace

void addHalt(CLI::App& app, CommandContext& context) {
    // Shared by CLI11, which fills it, and the callback, which reads it.
    auto options = std::make_shared<HaltOptions>();
    auto* command = app.add_subcommand(
        "halt",
        "Halt every skill of some servers, and wait until all stand still. This is not an "
        "emergency stop");
    addServerChoice(*command, options->servers);
    addServerSearch(*command, options->servers);
    command->add_option("--skill", options->skill, "Only the skill of this name");
    within(command->add_option("--timeout", options->timeout,
                               "Wait so long for standstill, of all together [s]"),
           0.1, 3'600.0);
    command->callback(
        [options, &context] { context.exit = exitOf(runHalt(*options, context.identity)); });
}

}  // namespace metier::app
