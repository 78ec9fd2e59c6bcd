#pragma once

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>

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
/// The same for what is wrong with the command line or with a file it names.
Exit reportUsage(const Error& error);

struct CommandContext;

// Each adds one subcommand, which stores in `exit`, or in the context, how it ended.
void addVirtual(CLI::App& app, Exit& exit);
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
void addFk(CLI::App& app, Exit& exit);
void addIk(CLI::App& app, Exit& exit);
void addCheck(CLI::App& app, Exit& exit);
void addPlot(CLI::App& app, Exit& exit);
void addGraph(CLI::App& app, Exit& exit);
void addSkillCommands(CLI::App& app, CommandContext& context);
void addOwn(CLI::App& app, CommandContext& context);
void addAudit(CLI::App& app, CommandContext& context);
void addDashboard(CLI::App& app, CommandContext& context);
void addHistory(CLI::App& app, Exit& exit);
void addReplay(CLI::App& app, CommandContext& context);
void addTrace(CLI::App& app, Exit& exit);
void addTrust(CLI::App& app, CommandContext& context);
void addUser(CLI::App& app, CommandContext& context);
void addCompletion(CLI::App& app, Exit& exit);

}  // namespace metier::app
