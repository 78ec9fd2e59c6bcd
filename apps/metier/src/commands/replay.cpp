// An execution that was recorded, once more: as a picture, or by its robot.
#include <fmt/format.h>

#include <memory>
#include <nlohmann/json.hpp>

#include "metier/cell/cell.hpp"
#include "metier/skill/values.hpp"
#include "motion_picture.hpp"
#include "printable.hpp"
#include "recorded.hpp"
#include "skill_run.hpp"

namespace metier::app {
namespace {

struct ReplayOptions {
    ExecutionDrawing drawing;
    bool run = false;
    std::string url;
    std::string cell;
    SkillRun how;
};

/// Present address of the execution's server.
Result<std::string> addressOf(const records::ExecutionRow& execution,
                              const ReplayOptions& options) {
    if (!options.url.empty()) {
        return options.url;
    }
    if (options.cell.empty()) {
        return fail(Errc::invalid_argument, fmt::format("say where server '{}' is: --url or --cell",
                                                        execution.server_name));
    }
    METIER_ASSIGN(const auto cell, cell::loadCell(options.cell));
    for (const auto& server : cell.servers) {
        if (server.name == execution.server_name) {
            return fmt::format("opc.tcp://{}:{}", server.address, server.port);
        }
    }
    return fail(Errc::invalid_argument,
                fmt::format("{}: there is no server '{}'", options.cell, execution.server_name));
}

/// The parameters as they were then, as far as the skill still has them.
Result<skill::ValueMap> parametersOf(const records::ExecutionRow& execution,
                                     const client::SkillHandle& skill) {
    const auto json = nlohmann::json::parse(execution.parameters, nullptr, false);
    if (!json.is_object()) {
        return fail(
            Errc::invalid_argument,
            fmt::format("execution {}: its parameters were not recorded", execution.number));
    }
    skill::ValueMap values;
    for (const auto& [name, value] : json.items()) {
        const auto& fields = skill.parameters();
        const auto field = std::find_if(fields.begin(), fields.end(),
                                        [&name = name](const auto& f) { return f.name == name; });
        if (field == fields.end()) {
            return fail(Errc::not_found, fmt::format("{} has no parameter '{}' any more",
                                                     skill.address().name, name));
        }
        METIER_ASSIGN(auto read, asUsage(skill::valueFrom(value, field->type, name)));
        values.emplace(name, std::move(read));
    }
    return values;
}

Result<Exit> runAgain(const ReplayOptions& options, const CommandIdentity& identity) {
    const link::StopSignal signal;
    METIER_ASSIGN(const auto store, records::Store::open(options.drawing.records));
    METIER_ASSIGN(const auto execution, store->find(options.drawing.id));
    METIER_ASSIGN(const auto url, asUsage(addressOf(execution, options)));
    const auto& controller = execution.controller;
    METIER_ASSIGN(
        auto open,
        openSkill(identity,
                  {url, controller.empty() ? execution.skill : controller + "/" + execution.skill},
                  OnLoss::reconnect));
    METIER_ASSIGN(const auto values, parametersOf(execution, open.skill));
    const auto checked = open.skill.check(values);
    if (!checked) {
        return reportOutcome(checked.error());
    }
    if (!checked->possible) {
        fmt::print(stderr, "metier: not started: {}\n", printable(checked->reason));
        return Exit::failed;
    }
    for (const auto& note : checked->notes) {
        fmt::print(stderr, "Check: {}\n", printable(note));
    }
    fmt::print(stderr, "Check: possible, planned {:.3f} s\n", checked->planned_duration);
    showConnection(*open.client);
    return runSkill(signal, open, values, options.how);
}

Result<Exit> runReplay(const ReplayOptions& options, const CommandIdentity& identity) {
    if (options.run == !options.drawing.svg.empty()) {
        return fail(Errc::invalid_argument,
                    "say either --svg FILE, to draw it, or --run, to run it again");
    }
    return options.run ? runAgain(options, identity) : drawExecution(options.drawing);
}

}  // namespace

void addReplay(CLI::App& app, CommandContext& context) {
    // Shared by CLI11, which fills it, and the callback, which reads it.
    auto options = std::make_shared<ReplayOptions>();
    auto& drawing = options->drawing;
    auto* command =
        app.add_subcommand("replay", "Draw a recorded execution, or run it again after Check");
    command->footer(
        "--run starts the same skill with the same parameters: an arm moves. It begins where it\n"
        "stands now, so its path may be another. Ctrl-C halts it. Exit status as of `metier run`.");
    command->add_option("ID", drawing.id, "Its number or its id, as `metier history` shows it")
        ->required();
    addRecords(*command, drawing.records);
    command->add_option("--svg", drawing.svg, "Draw it into this file; -: standard output");
    command->add_option("--robot", drawing.robot,
                        "The robot to draw; without it the one of its device's name");
    command->add_option("--tool", drawing.tool, "Whose path is drawn; without it the flange");
    command->add_flag("--run", options->run, "Run it again");
    command->add_option("--url", options->url, "Address of its server: opc.tcp://host:port");
    command->add_option("--cell", options->cell, "Take the server of its name in this cell file");
    within(command->add_option("--timeout", options->how.timeout, "Halt it after so long [s]"), 0.1,
           86'400.0);
    addOwnerOptions(*command, options->how.owner,
                    "Take control for the run; it is lost after so long without a heartbeat, such "
                    "as 300ms");
    command->add_flag("--json", options->how.json, "Print the result as JSON");
    command->callback(
        [options, &context] { context.exit = exitOf(runReplay(*options, context.identity)); });
}

}  // namespace metier::app
