// suspend, resume and reset: one method of one skill, and the state that follows.
#include <fmt/format.h>

#include <array>
#include <chrono>
#include <memory>

#include "metier/client/skill_handle.hpp"
#include "servers.hpp"

namespace metier::app {
namespace {

using skill::Method;
using skill::State;

constexpr auto kResetTimeout = std::chrono::seconds(30);
constexpr auto kLongestBraking = std::chrono::seconds(2);
constexpr auto kResetPause = std::chrono::milliseconds(100);

struct Command {
    const char* name;
    const char* help;
    Method method;
    State then;
};

constexpr std::array kCommands{
    Command{"suspend", "Pause a running skill at standstill on its path; resume goes on",
            Method::suspend, State::suspended},
    Command{"resume",
            "Continue a suspended skill where it stopped, and stay until it ends: it may have "
            "no other owner",
            Method::resume, State::running},
    Command{"reset", "Make a halted skill ready again, or give a suspended one up", Method::reset,
            State::ready},
};

struct CommandOptions {
    SkillChoice choice;
    double timeout = 60.0;
};

/// Keeps the session, whose end could be the loss of the owner, while the skill runs.
Exit stayUntilEnd(OpenSkill& open, const CommandOptions& options) {
    std::fflush(stdout);
    const auto ended = open.skill.awaitEnd(deadlineIn(options.timeout));
    if (!ended) {
        return reportOutcome(ended.error());
    }
    fmt::print("{} {}\n", options.choice.skill, toString(ended->to));
    return Exit::success;
}

/// Whether a refused Reset may be asked again: by a controller that takes longer for it than its
/// server waits, and by an arm that has yet to come to rest.
bool mayAskAgain(const opcua::Failure& refused, std::chrono::steady_clock::duration asked_for) {
    return (refused.code == Errc::timeout && asked_for < kResetTimeout) ||
           (refused.code == Errc::resource_unavailable && asked_for < kLongestBraking);
}

opcua::Answer<> call(client::SkillHandle& skill, const Command& command) {
    const auto begin = std::chrono::steady_clock::now();
    auto called = skill.call(command.method);
    while (command.method == Method::reset && !called &&
           mayAskAgain(called.error(), std::chrono::steady_clock::now() - begin)) {
        // The server is not to be kept busy: it may be ready by itself meanwhile, or not.
        if (skill.awaitState(command.then, std::chrono::steady_clock::now() + kResetPause)) {
            return {};
        }
        called = skill.call(command.method);
    }
    return called;
}

/// Suspended follows at standstill, unless the skill reaches its end before, or is halted.
Result<void> awaitSuspended(client::SkillHandle& skill, const CommandOptions& options) {
    METIER_ASSIGN(const auto stands, skill.awaitRest(deadlineIn(options.timeout)));
    if (stands == State::ready) {
        return fail(Errc::invalid_state,
                    options.choice.skill + " has reached its end: it is Ready, not Suspended");
    }
    if (stands == State::halted) {
        return fail(Errc::invalid_state, fmt::format("{} is Halted, not Suspended: {}",
                                                     options.choice.skill, skill.reasonText()));
    }
    return {};
}

Result<Exit> runCommand(const Command& command, const CommandOptions& options,
                        const CommandIdentity& identity) {
    const bool stays = command.method == Method::resume;
    METIER_ASSIGN(auto open,
                  openSkill(identity, options.choice, stays ? OnLoss::reconnect : OnLoss::fail));
    showConnection(*open.client);
    if (const auto called = call(open.skill, command); !called) {
        return reportOutcome(called.error());
    }
    if (command.method == Method::suspend) {
        METIER_TRY(awaitSuspended(open.skill, options));
    }
    fmt::print("{} {}\n", options.choice.skill, toString(command.then));
    return stays ? stayUntilEnd(open, options) : Exit::success;
}

}  // namespace

void addSkillCommands(CLI::App& app, CommandContext& context) {
    for (const auto& each : kCommands) {
        // Shared by CLI11, which fills it, and the callback, which reads it.
        auto options = std::make_shared<CommandOptions>();
        auto* command = app.add_subcommand(each.name, each.help);
        addSkillChoice(*command, options->choice);
        if (each.method != Method::reset) {
            within(
                command->add_option("--timeout", options->timeout,
                                    "Wait so long for standstill, or for the end after resume [s]"),
                0.1, 3'600.0);
        }
        command->callback([each, options, &context] {
            context.exit = exitOf(runCommand(each, *options, context.identity));
        });
    }
}

}  // namespace metier::app
