#include <fmt/format.h>

#include <memory>
#include <utility>

#include "metier/client/lack.hpp"
#include "metier/client/skill_handle.hpp"
#include "printable.hpp"
#include "recorded.hpp"
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
        METIER_ASSIGN(auto parsed, parseSetting(skill, setting));
        values.insert_or_assign(parsed.first, std::move(parsed.second));
    }
    return values;
}

/// Prints how to reset a skill that is Halted: until then it runs nothing.
void showWayOut(OpenSkill& open, const std::string& name) {
    if (open.skill.state() == skill::State::halted) {
        fmt::print(stderr, "metier: {} is Halted; `metier reset {} {}` makes it Ready\n",
                   printable(name), printable(open.url), printable(name));
    }
}

Result<Exit> runRun(const RunOptions& options, const CommandIdentity& identity) {
    const link::StopSignal signal;
    METIER_ASSIGN(auto open, openSkill(identity, options.choice, OnLoss::reconnect));
    auto& skill = open.skill;
    showConnection(*open.client);
    if (options.fields) {
        printFields(skill);
        return Exit::success;
    }
    METIER_ASSIGN(const auto values, asUsage(parseSettings(skill, options.settings)));
    if (const auto lacks = skill.lacks(); !lacks.empty()) {
        fmt::print(stderr, "metier: {} has {}\n", printable(options.choice.skill),
                   explanationOf(lacks));
    }
    const auto exit = runSkill(signal, open, values, options.run);
    if (exit == Exit::failed) {
        showWayOut(open, options.choice.skill);
    }
    return exit;
}

}  // namespace

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
    within(
        command->add_option("--timeout", options->run.timeout, "Halt the skill after so long [s]"),
        0.1, 86'400.0);
    addOwnerOptions(*command, options->run.owner,
                    "Take control for the run; it is lost after so long without a heartbeat, such "
                    "as 300ms");
    command->add_flag("--json", options->run.json, "Print the result as JSON");
    addRecords(*command, options->run.records,
               "Where the run is recorded, if its server is of another maker and records nothing "
               "(off: nowhere)");
    command->callback(
        [options, &context] { context.exit = exitOf(runRun(*options, context.identity)); });
}

}  // namespace metier::app
