#pragma once

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>

#include <string>
#include <utility>

#include "metier/base/error.hpp"

namespace metier::app {

/// Exit status of the program.
enum class Exit : int {
    success = 0,
    failed = 1,          ///< a server, a skill or a device refused, failed or was not there
    usage = 2,           ///< the command line or a file is wrong
    unknown = 3,         ///< the connection was lost, and the outcome is unknown
    execution_lost = 4,  ///< the server was started again: what ran there is over
};

/// Prints the error to standard error and gives the exit status that fits it.
Exit report(const Error& error);
/// The exit status of a command; reports the error of one that failed.
Exit exitOf(const Result<Exit>& ended);
/// Turns an error into one of the command line or of a file that it names: exit status `usage`.
template <typename T>
Result<T> asUsage(Result<T> result) {
    return std::move(result).map_error([](Error error) {
        return Error{Errc::invalid_argument, std::move(error.message)};
    });
}
/// Writes a file. Errors: invalid_argument if it cannot be written.
Result<void> writeFile(const std::string& file, const std::string& text);

/// Limits an option to [low, high]; the help shows its default.
template <typename T>
void within(CLI::Option* option, T low, T high) {
    option->check(CLI::Range(low, high))->capture_default_str();
}

struct CommandContext;

// Each adds one subcommand, which stores in the context how it ended.
void addVirtual(CLI::App& app, CommandContext& context);
void addUp(CLI::App& app, CommandContext& context);
void addServe(CLI::App& app, CommandContext& context);
void addList(CLI::App& app, CommandContext& context);
void addRun(CLI::App& app, CommandContext& context);
void addWatch(CLI::App& app, CommandContext& context);
void addHalt(CLI::App& app, CommandContext& context);
void addPickPlace(CLI::App& app, CommandContext& context);
void addFind(CLI::App& app, CommandContext& context);
void addDiscovery(CLI::App& app, CommandContext& context);
void addSquare(CLI::App& app, CommandContext& context);
void addDemo(CLI::App& app, CommandContext& context);
void addFk(CLI::App& app, CommandContext& context);
void addIk(CLI::App& app, CommandContext& context);
void addCheck(CLI::App& app, CommandContext& context);
void addPlot(CLI::App& app, CommandContext& context);
void addRobotFiles(CLI::App& app, CommandContext& context);
void addGraph(CLI::App& app, CommandContext& context);
void addTypes(CLI::App& app, CommandContext& context);
void addSkillCommands(CLI::App& app, CommandContext& context);
void addOwn(CLI::App& app, CommandContext& context);
void addAudit(CLI::App& app, CommandContext& context);
void addDashboard(CLI::App& app, CommandContext& context);
void addHistory(CLI::App& app, CommandContext& context);
void addReplay(CLI::App& app, CommandContext& context);
void addTrace(CLI::App& app, CommandContext& context);
void addTrust(CLI::App& app, CommandContext& context);
void addUser(CLI::App& app, CommandContext& context);
void addCompletion(CLI::App& app, CommandContext& context);

}  // namespace metier::app
