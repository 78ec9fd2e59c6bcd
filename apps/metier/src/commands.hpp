#pragma once

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>

#include "metier/base/error.hpp"

namespace metier::app {

/// What the program returns to the shell.
enum class Exit : int {
    success = 0,
    failed = 1,          ///< a server, a skill or a device refused, failed or was not there
    usage = 2,           ///< the command line or a file is wrong
    unknown = 3,         ///< the connection was lost: nobody here knows what became of it
    execution_lost = 4,  ///< the server was started again: what ran there is over
};

/// Prints the error to standard error and gives the exit status that fits it.
Exit report(const Error& error);
/// The same for what is wrong with the command line or with a file it names.
Exit reportUsage(const Error& error);

// Each adds one subcommand, which stores in `exit` how it ended.
void addVirtual(CLI::App& app, Exit& exit);
void addUp(CLI::App& app, Exit& exit);
void addServe(CLI::App& app, Exit& exit);
void addList(CLI::App& app, Exit& exit);
void addRun(CLI::App& app, Exit& exit);
void addWatch(CLI::App& app, Exit& exit);
void addHalt(CLI::App& app, Exit& exit);
void addPickPlace(CLI::App& app, Exit& exit);
void addFind(CLI::App& app, Exit& exit);
void addDiscovery(CLI::App& app, Exit& exit);
void addSquare(CLI::App& app, Exit& exit);
void addDemo(CLI::App& app, Exit& exit);
void addFk(CLI::App& app, Exit& exit);
void addIk(CLI::App& app, Exit& exit);
void addCheck(CLI::App& app, Exit& exit);
void addPlot(CLI::App& app, Exit& exit);
void addGraph(CLI::App& app, Exit& exit);
void addSkillCommands(CLI::App& app, Exit& exit);
void addOwn(CLI::App& app, Exit& exit);
void addAudit(CLI::App& app, Exit& exit);
void addDashboard(CLI::App& app, Exit& exit);
void addHistory(CLI::App& app, Exit& exit);
void addReplay(CLI::App& app, Exit& exit);
void addTrace(CLI::App& app, Exit& exit);
void addTrust(CLI::App& app, Exit& exit);
void addUser(CLI::App& app, Exit& exit);
void addCompletion(CLI::App& app, Exit& exit);

}  // namespace metier::app
