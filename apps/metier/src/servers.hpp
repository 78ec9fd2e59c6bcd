#pragma once

#include <memory>
#include <string>
#include <vector>

#include "command_context.hpp"
#include "metier/base/error.hpp"
#include "metier/client/skill_handle.hpp"
#include "metier/opcua/client.hpp"
#include "server_search.hpp"

namespace metier::app {

/// The time when so many seconds are over.
SteadyTime deadlineIn(double seconds);

/// Reaction of a command to the loss of its connection.
enum class OnLoss { fail, reconnect };

/// Whether a text is the address of a server rather than a file: "opc.tcp://...".
bool isAddress(const std::string& text);

/// Connects within 5 s. The error names the address.
Result<std::unique_ptr<opcua::Client>> connectTo(const CommandIdentity& identity,
                                                 const std::string& url,
                                                 OnLoss on_loss = OnLoss::fail);
/// "connection back; server restarted: no", for people.
std::string textOf(const opcua::ConnectionChange& change);
/// Prints each loss and return of the connection to standard error.
void showConnection(opcua::Client& client);

/// Prints what became of an execution that did not finish, and gives the exit status for it.
Exit reportOutcome(const opcua::Failure& failure);

/// One skill of one server, for a command that names both, or only the skill.
struct SkillChoice {
    std::string url;  ///< empty: that of `servers` which has the skill
    std::string skill;
    ServerChoice servers{};
};

/// Takes a single argument that is no address for the skill's name.
void sortArguments(SkillChoice& choice);
/// Adds the arguments for it to a command. `choice` must outlive the command line.
void addSkillChoice(CLI::App& command, SkillChoice& choice);

/// A skill and the client that leads to it.
struct OpenSkill {
    std::string url;
    std::unique_ptr<opcua::Client> client;
    client::SkillHandle skill;  // ends before its client
};

/// Errors: those of connectTo(), findSkill(), SkillHandle::open() and, without an address, of
///         serversOf(); not_found or invalid_argument if none or several servers have the skill.
Result<OpenSkill> openSkill(const CommandIdentity& identity, const SkillChoice& choice,
                            OnLoss on_loss = OnLoss::fail);

}  // namespace metier::app
