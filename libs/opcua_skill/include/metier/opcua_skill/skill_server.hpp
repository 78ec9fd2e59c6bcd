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

/// Naming of the nodes below a published skill.
enum class NodeStyle {
    /// String ids that are paths, `<skills>/<name>/ParameterSet/...`; descriptions.
    readable,
    /// For thousands of skills, at 40 % of the memory: numeric ids, no descriptions below the
    /// skill, ProgramDiagnostic as one value without components, and the methods of Part 10 only.
    compact,
};

/// The skills of one OPC UA server: each is a Program served at the nodes of a skill object.
///
///     auto skills = SkillServer::create(*server, clock);
///     auto system = findMotionDeviceSystem(server->nodes());
///     (*skills)->publish(system->skills, std::make_unique<WaveSkill>());
///     server->start();
///
/// Clients read the present content of a Program. A refused call or write gives a StatusCode; the
/// text with value, limit and unit is then in the skill's Variable `ReasonText` (namespace
/// urn:metier:skills), for the same session only and until it sends an accepted command to that
/// skill. Other sessions read there the reason of the skill's state.
///
/// Threading: before Server::start() the thread that created the server, afterwards the server's.
class SkillServer {
public:
    /// \param server with the NodeSets device, robotics and metier; must outlive this
    /// \param clock  must outlive this
    /// \param logger shared with its other users, as spdlog does; null: spdlog's default logger
    /// \param executor runs on the server's thread; for a clock that tests move by hand. Null: one
    ///                 in real time
    /// Errors: not_found, naming what the server's NodeSets lack.
    static Result<std::unique_ptr<SkillServer>> create(
        opcua::Server& server, const Clock& clock, std::shared_ptr<spdlog::logger> logger = nullptr,
        std::shared_ptr<skill::Executor> executor = nullptr);
    /// Stops the server, since its nodes refer to this object, then the Programs. Must not run on
    /// the server's thread.
    ~SkillServer();
    SkillServer(const SkillServer&) = delete;
    SkillServer& operator=(const SkillServer&) = delete;

    /// Executor on the server's thread, for Programs. Any thread.
    std::shared_ptr<skill::Executor> executor() const;

    /// Serves a skill at an existing object, for example of a NodeSet. Parameters of the object
    /// that the skill does not have become read-only. Fields of the skill without a node are left
    /// out if the type declares them as Optional and no client must write them.
    /// \param skill not null
    /// \return the Program, which lives as long as this
    /// Errors: not_found, naming all other fields of the skill without a node; type_mismatch,
    ///         naming every field whose node has another data type; already_exists (bound before).
    ///         Throws as the constructor of skill::Program.
    Result<skill::Program*> bind(const opcua::NodeId& skill_object,
                                 std::unique_ptr<skill::Skill> skill,
                                 skill::ProgramOptions options = {});

    /// Makes a skill object below `skills` and serves the skill there. Its type is the subtype of
    /// SkillType with the name SkillDescription::type; its id is `<skills>/<name>`. All ids follow
    /// from names, so they are the same at every start. Nodes that are the same for the whole type
    /// (units, ranges, properties of Programs) are not copied: the instance refers to those of the
    /// type.
    /// Errors: not_found (the type); all else as bind().
    Result<skill::Program*> publish(const opcua::NodeId& skills,
                                    std::unique_ptr<skill::Skill> skill,
                                    skill::ProgramOptions options = {},
                                    NodeStyle style = NodeStyle::readable);

    /// Serves the control of a controller: its lease, and its DI Lock if it has one. Put the same
    /// Control into the options of the Programs of its skills.
    /// Errors: not_found, if the controller has no lease.
    Result<void> serveControl(const opcua::NodeId& controller,
                              std::shared_ptr<skill::Control> control);

    /// Publishes the last executions of each skill that is served so far, see
    /// publishExecutionRecords(). Call it once, before Server::start().
    Result<void> publishRecords();

    /// Brakes all running Programs, also those that a client starts meanwhile, and waits until all
    /// are at rest; for the end of a server. They are Halted with an error and the text `why`.
    /// \param longest time to wait; an answer of the server's thread that comes late can double it
    /// \return false if something still runs after `longest`
    /// Threads: any but the server's, while the server serves.
    bool comeToRest(const std::string& why, std::chrono::milliseconds longest);

    /// All Programs, in the order in which they were added; they end in reverse order. The pointers
    /// are valid as long as this.
    std::vector<skill::Program*> programs() const;

private:
    struct State;
    explicit SkillServer(std::unique_ptr<State> state);

    std::unique_ptr<State> state_;
};

}  // namespace metier::opcua_skill
