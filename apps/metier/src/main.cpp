#include <fmt/format.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <exception>
#include <string>
#include <vector>

#include "command_context.hpp"
#include "commands.hpp"
#include "printable.hpp"
#include "security_options.hpp"

namespace {

constexpr const char* kAbout =
    "Skills of robots and tools over OPC UA.\n"
    "metier is not safety-rated: the safety of a cell must never depend on it.\n\n"
    "A first look:\n"
    "  metier up cells/demo.toml                       start the demo cell\n"
    "  metier list --cell cells/demo.toml              what it offers\n"
    "  metier run opc.tcp://127.0.0.1:48421 JointPtpMoveSkill --fields\n"
    "  metier square --cell cells/demo.toml            move every arm along a square\n"
    "  metier pick-place --cell cells/pick_and_place.toml   pick and place ten parts each\n"
    "Without a server:\n"
    "  metier check ur5 --to-pose 0.4,-0.1,0.3,3.14,0,0 --linear    would it move, and how";

void addCommands(CLI::App& app, metier::app::CommandContext& context) {
    using namespace metier::app;
    for (const auto add :
         {addDemo,          addUp,     addServe,     addList,      addRun,     addWatch, addHalt,
          addSkillCommands, addOwn,    addAudit,     addHistory,   addReplay,  addTrace, addFind,
          addDiscovery,     addSquare, addPickPlace, addFk,        addIk,      addCheck, addPlot,
          addRobotFiles,    addGraph,  addTypes,     addDashboard, addVirtual, addTrust, addUser,
          addCompletion}) {
        add(app, context);
    }
}

/// Sends the log to standard error, since standard output belongs to results.
void setUpLog(const std::string& level) {
    spdlog::set_default_logger(spdlog::stderr_color_mt("metier"));
    spdlog::set_formatter(metier::app::printableLog("%Y-%m-%d %H:%M:%S.%e %^%l%$ %v"));
    spdlog::set_level(spdlog::level::from_str(level));
}

/// The arguments, last first as CLI11 takes them. It takes one that begins with '-' for an option
/// unless a digit follows; a space before -.5, -inf and -nan makes them values.
std::vector<std::string> argumentsOf(int argc, char** argv) {
    std::vector<std::string> arguments(argv + 1, argv + argc);
    for (auto& argument : arguments) {
        const bool value = argument.starts_with("-.") || argument.starts_with("-inf") ||
                           argument.starts_with("-nan");
        argument.insert(0, value ? " " : "");
    }
    std::reverse(arguments.begin(), arguments.end());
    return arguments;
}

int run(int argc, char** argv) {
    using metier::app::Exit;
    metier::app::CommandContext context;
    std::string log_level = "warning";
    CLI::App app(kAbout, "metier");
    app.set_version_flag("--version", METIER_VERSION);
    app.require_subcommand(1);
    app.failure_message(CLI::FailureMessage::help);
    app.add_option("--log", log_level, "Least severity to log: debug, info, warning or error")
        ->check(CLI::IsMember({"debug", "info", "warning", "error"}))
        ->capture_default_str();
    app.fallthrough();  // the options of every command may follow it
    metier::app::addSecurityOptions(app, context);
    // The log must be set up before a subcommand runs; its callback comes after this one.
    app.parse_complete_callback([&log_level] { setUpLog(log_level); });
    addCommands(app, context);
    try {
        app.parse(argumentsOf(argc, argv));
    } catch (const CLI::ParseError& error) {
        return static_cast<int>(app.exit(error) == 0 ? Exit::success : Exit::usage);
    }
    return static_cast<int>(context.exit);
}

}  // namespace

int main(int argc, char** argv) {
    try {
        return run(argc, argv);
    } catch (const std::exception& error) {
        fmt::print(stderr, "metier: {}\n", error.what());
        return static_cast<int>(metier::app::Exit::failed);
    }
}
