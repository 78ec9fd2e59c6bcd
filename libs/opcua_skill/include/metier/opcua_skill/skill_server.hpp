#pragma once

#include <spdlog/logger.h>

#include <chrono>
#include <memory>
#include <string>
#include <vector>

#include "metier/base/clock.hpp"
#include "metier/base/error.hpp"
#include "metier/opcua/server.hpp"
#include "metier/skill/executor.hpp"
#include "metier/skill/program.hpp"
#include "metier/skill/skill.hpp"

namespace metier::opcua_skill {

/// How the nodes below a published skill are named.
enum class NodeStyle {
    readable,  ///< string ids that are paths, `<skills>/<name>/ParameterSet/...`; descriptions
    compact,   ///< for thousands of skills, at 40 % of the memory: numeric ids, no descriptions
               ///< below the skill, ProgramDiagnostic as one value without components,
               ///< and the methods of Part 10 only
};

/// The skills of one OPC UA server: each is a Program served at the nodes of a skill object.
///
/// What clients see of a skill is read from its Program when they ask. A refused call or write
/// tells a StatusCode; the text with value, limit and unit is what the same session then reads
/// from the skill's Variable `ReasonText` (namespace urn:metier:skills), until a later command of
/// that session to that skill is accepted. Other sessions read there why the skill is in its state.
///
/// Threading: before Server::start() the thread that created the server, afterwards the server's.
class SkillServer {
public:
    /// \param server with the NodeSets device, robotics and metier; must outlive this
    /// \param clock  must outlive this
    /// \param logger shared with its other users, as spdlog does; null: spdlog's default logger
    /// \param executor that runs on the server's thread, for a clock that is moved by hand; null:
    ///                 one in real time
    /// Errors: not_found, naming what the server's NodeSets lack.
    static Result<std::unique_ptr<SkillServer>> create(
        opcua::Server& server, const Clock& clock, std::shared_ptr<spdlog::logger> logger = nullptr,
        std::shared_ptr<skill::Executor> executor = nullptr);
    /// Stops the server, since its nodes lead here; then the Programs.
    /// Not on the server's thread.
    ~SkillServer();
    SkillServer(const SkillServer&) = delete;
    SkillServer& operator=(const SkillServer&) = delete;

    /// The server's thread as the owner of Programs. Any thread.
    std::shared_ptr<skill::Executor> executor() const;

    /// Serves a skill at an object that exists, for example from a NodeSet. Its parameters that the
    /// skill does not have become read-only. Results and parameters for which the object has no
    /// node are left out where its type declares them as Optional and nobody need give them.
    /// \return the Program, which lives as long as this
    /// Errors: not_found, naming every other field of the skill that the object has no node for;
    ///         type_mismatch, naming every field whose node has another data type;
    ///         already_exists (bound before).
    Result<skill::Program*> bind(const opcua::NodeId& skill_object,
                                 std::unique_ptr<skill::Skill> skill,
                                 skill::ProgramOptions options = {});

    /// Makes a skill object below `skills` and serves the skill there. Its type is the subtype of
    /// SkillType that is called as SkillDescription::type says; its id is `<skills>/<name>`. All
    /// ids follow from names, so that they are the same at every start. What does not differ from
    /// the type (units, ranges, properties of Programs) is not made again: the instance refers to
    /// the type's node.
    /// Errors: not_found (the type); all else as bind().
    Result<skill::Program*> publish(const opcua::NodeId& skills,
                                    std::unique_ptr<skill::Skill> skill,
                                    skill::ProgramOptions options = {},
                                    NodeStyle style = NodeStyle::readable);

    /// Serves the control of a controller: its lease, and its DI Lock if it has one. The Programs
    /// of its skills get the same Control in their options.
    /// Errors: not_found, if the controller has no lease.
    Result<void> serveControl(const opcua::NodeId& controller,
                              std::shared_ptr<skill::Control> control);

    /// Shows the last executions of each skill that is served by now, see
    /// publishExecutionRecords(). Before Server::start(); once.
    Result<void> publishRecords();

    /// Brakes what runs, and what a client starts meanwhile, and waits until all Programs rest: for
    /// the end of a server. What runs is Halted for an error, with `why`.
    /// \return false if something still runs after `longest`
    /// Threads: any but the server's, while the server serves.
    bool comeToRest(const std::string& why, std::chrono::milliseconds longest);

    /// All Programs, in the order in which they came; they end in the opposite one.
    std::vector<skill::Program*> programs() const;

private:
    class State;
    explicit SkillServer(std::unique_ptr<State> state);

    std::unique_ptr<State> state_;
};

}  // namespace metier::opcua_skill
