#include <fmt/format.h>

#include <chrono>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <thread>

#include "metier/skill/json.hpp"
#include "metier/client/control_handle.hpp"
#include "metier/client/skill_handle.hpp"
#include "printable.hpp"
#include "skill_run.hpp"
#include "value_text.hpp"

namespace metier::app {
namespace {

using client::SkillHandle;

struct RunOptions {
    SkillChoice choice;
    std::vector<std::string> settings;
    SkillRun run;
    bool fields = false;
};

void printField(const skill::Field& field) {
    std::string range;
    if (field.range) {
        range = fmt::format("{:g} to {:g}", field.range->low, field.range->high);
    }
    fmt::print("  {:<22} {:<34} {:<8} {:<18} {}\n", field.name, notation(field.type),
               field.unit.symbol, range, field.description);
}

void printFields(const SkillHandle& skill) {
    fmt::print("{} ({})\nparameters, for --set Name=value:\n", skill.address().name,
               skill.address().type_name);
    for (const auto& field : skill.parameters()) {
        printField(field);
    }
    fmt::print("results:\n");
    for (const auto& field : skill.results()) {
        printField(field);
    }
}

/// "Name=value" as a parameter of the skill.
Result<std::pair<std::string, skill::Value>> parseSetting(const SkillHandle& skill,
                                                          const std::string& setting) {
    const auto equals = setting.find('=');
    const auto name = setting.substr(0, equals);
    if (equals == std::string::npos) {
        return fail(Errc::invalid_argument, fmt::format("'{}' is not Name=value", setting));
    }
    for (const auto& field : skill.parameters()) {
        if (field.name != name) {
            continue;
        }
        auto value = parseValue(field.type, setting.substr(equals + 1));
        if (!value) {
            return fail(Errc::invalid_argument, fmt::format("{}: {}", name, value.error().message));
        }
        return std::pair(name, std::move(*value));
    }
    return fail(Errc::invalid_argument,
                fmt::format("{} has no parameter '{}'; see --fields", skill.address().name, name));
}

Result<skill::ValueMap> parseSettings(const SkillHandle& skill,
                                      const std::vector<std::string>& settings) {
    skill::ValueMap values;
    for (const auto& setting : settings) {
        auto parsed = parseSetting(skill, setting);
        if (!parsed) {
            return fail(parsed.error());
        }
        values.insert_or_assign(parsed->first, std::move(parsed->second));
    }
    return values;
}

void printResult(const skill::ValueMap& result, bool as_json) {
    if (as_json) {
        fmt::print("{}\n", skill::toJson(result).dump(2, ' ', false,
                                                      nlohmann::json::error_handler_t::replace));
        return;
    }
    fmt::print("done\n");
    for (const auto& [name, value] : result) {
        fmt::print("  {:<22} {}\n", name, printable(skill::toString(value)));
    }
}

/// Ctrl-C halts the skill; the run then ends with the Halted that follows.
class HaltOnSignal {
public:
    HaltOnSignal(const link::StopSignal& signal, opcua::Client& client,
                 client::SkillAddress skill)
        : thread_([&signal, &client, skill = std::move(skill)](const std::stop_token& stop) {
              while (!stop.stop_requested()) {
                  if (signal.waitUntil(std::chrono::steady_clock::now() + kLook)) {
                      halt(client, skill);
                      return;
                  }
              }
          }) {}

private:
    static constexpr std::chrono::milliseconds kLook{100};

    static void halt(opcua::Client& client, const client::SkillAddress& skill) {
        const auto method = client.translate(skill.node, {{0, "Halt"}});
        const auto called = method
                                ? client.call(skill.node, *method)
                                : opcua::Answer<opcua::CallResult>(tl::unexpected(method.error()));
        if (called) {
            return;
        }
        fmt::print(stderr, "metier: Halt: {}\n", printable(called.error().message));
        if (called.error().delivery != opcua::Failure::Delivery::answered) {
            client.close();  // the user does not wait for the connection: the run ends as unknown
        }
    }

    std::jthread thread_;
};

void showTransitions(SkillHandle& skill) {
    skill.onTransition([](const skill::TransitionEvent& event) {
        fmt::print(stderr, "{} to {}{}{}\n", toString(event.from), toString(event.to),
                   event.reason_text.empty() ? "" : ": ", event.reason_text);
    });
}

struct OwnedRun {
    const skill::ValueMap& values;
    SteadyTime deadline;
    const OwnerOptions& owner;
};

/// Runs the skill as the command line says, under a lease, with a choice for the loss of this
/// client; with an id, so that its end is learnt whatever the network does. Servers that know no
/// executions get plain writes and Start.
opcua::Answer<skill::ValueMap> runOwned(SkillHandle& skill, opcua::Client& client,
                                        const OwnedRun& run) {
    std::optional<client::ControlHandle> control;
    if (run.owner.lease_ms != 0) {
        const auto* controller = skill.address().controller();
        auto taken = client::ControlHandle::acquire(
            client, controller == nullptr ? opcua::NodeId() : controller->node,
            {.lease = run.owner.lease(), .on_loss = run.owner.action()});
        if (!taken) {
            return tl::unexpected(taken.error());
        }
        control = std::move(*taken);
    }
    if (!control && run.owner.action() == skill::OwnerLossAction::skill_default &&
        !skill.knowsExecutions()) {
        return skill.run(run.values, run.deadline);
    }
    return skill.runWith({.parameters = run.values,
                          .on_owner_loss = run.owner.action(),
                          .epoch = control ? control->epoch() : 0},
                         run.deadline);
}

/// A skill that is Halted runs nothing until somebody resets it.
void showWayOut(SkillHandle& skill, const SkillChoice& choice) {
    if (skill.state() == skill::State::halted) {
        fmt::print(stderr, "metier: {} is Halted; `metier reset {} {}` makes it Ready\n",
                   printable(choice.skill), printable(choice.url), printable(choice.skill));
    }
}

Exit runRun(const RunOptions& options, const CommandIdentity& identity) {
    const link::StopSignal signal;
    auto open = openSkill(identity, options.choice, OnLoss::reconnect);
    if (!open) {
        return report(open.error());
    }
    auto& skill = open->skill;
    showConnection(*open->client);
    if (options.fields) {
        printFields(skill);
        return Exit::success;
    }
    const auto values = parseSettings(skill, options.settings);
    if (!values) {
        return reportUsage(values.error());
    }
    const auto exit = runSkill(signal, *open, *values, options.run);
    if (exit == Exit::failed) {
        showWayOut(skill, options.choice);
    }
    return exit;
}

}  // namespace

Exit runSkill(const link::StopSignal& signal, OpenSkill& open, const skill::ValueMap& values,
              const SkillRun& run) {
    auto& skill = open.skill;
    showTransitions(skill);
    const HaltOnSignal halt_on_signal(signal, *open.client, skill.address());
    const auto deadline =
        std::chrono::steady_clock::now() + std::chrono::duration_cast<std::chrono::nanoseconds>(
                                               std::chrono::duration<double>(run.timeout));
    const auto result = runOwned(skill, *open.client, {values, deadline, run.owner});
    if (!result) {
        return reportOutcome(result.error());
    }
    printResult(*result, run.json);
    return Exit::success;
}

void addRun(CLI::App& app, CommandContext& context) {
    // Shared by CLI11, which fills it, and the callback, which reads it.
    auto options = std::make_shared<RunOptions>();
    auto* command = app.add_subcommand(
        "run",
        "Set a skill's parameters, start it and wait for its end, also over losses of the "
        "connection; Ctrl-C halts it.\nExit status: 0 finished, 1 refused, failed or halted, 2 "
        "usage, 3 unknown what became of it, 4 the server was started again: it is over");
    addSkillChoice(*command, options->choice);
    command->add_option("--set", options->settings, "A parameter: Name=value, as --fields says")
        ->type_name("Name=value")
        ->allow_extra_args(false);
    command->add_flag("--fields", options->fields,
                      "Only show the skill's parameters and results with units and ranges");
    command->add_option("--timeout", options->run.timeout, "Halt the skill after so long [s]")
        ->check(CLI::Range(0.1, 86'400.0))
        ->capture_default_str();
    addOwnerOptions(*command, options->run.owner,
                    "Take control for the run; it is lost after so long without a heartbeat, such "
                    "as 300ms");
    command->add_flag("--json", options->run.json, "Print the result as JSON");
    command->callback([options, &context] { context.exit = runRun(*options, context.identity); });
}

}  // namespace metier::app
