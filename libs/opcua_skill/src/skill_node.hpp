#pragma once

#include <spdlog/logger.h>

#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "metier/opcua/event_emitter.hpp"
#include "metier/opcua/server.hpp"
#include "metier/skill/program.hpp"
#include "model_ids.hpp"
#include "node_limits.hpp"
#include "node_role.hpp"
#include "pending_checks.hpp"
#include "skill_factory.hpp"

namespace metier::opcua_skill {

class SkillNode;

/// Why the last command or value of each session was refused; kept for as long as the session.
///
/// Threading: the server's thread.
class Refusals {
public:
    void refused(const opcua::Session& session, const SkillNode& skill, std::string text);
    void accepted(const opcua::Session& session, const SkillNode& skill);
    void sessionClosed(const opcua::Session& session) { last_.erase(session.id); }
    /// Null if the last command of the session to that skill was not refused.
    const std::string* find(const opcua::Session& session, const SkillNode& skill) const;

private:
    struct Entry {
        const SkillNode* skill = nullptr;
        std::string text;
    };
    std::map<opcua::NodeId, Entry> last_;
};

/// Data that all skills of one server share.
struct SkillContext {
    ModelIds ids;
    opcua::EventEmitter emitter;   ///< for transitions
    opcua::EventEmitter stopping;  ///< for executions that begin to come to rest
    Refusals refusals;
    opcua::Server& server;
    std::shared_ptr<spdlog::logger> log;  // shared with its other users, as spdlog does
};

/// Serves one Program at the nodes of one skill: values are read from the Program when a client
/// asks, so that no client ever sees them half changed; each transition raises one event.
///
/// Threading: the server's thread.
class SkillNode final : public opcua::VariableHandler, private skill::ProgramObserver {
public:
    /// \param id   of the skill object
    /// \param context must outlive the node
    SkillNode(opcua::NodeId id, std::unique_ptr<skill::Program> program, SkillContext& context);
    ~SkillNode() override;
    SkillNode(const SkillNode&) = delete;
    SkillNode& operator=(const SkillNode&) = delete;

    /// Makes the nodes of the skill read from and write to the Program. Once.
    Result<void> bind(opcua::AddressSpace& nodes, const std::vector<BoundNode>& bound);

    const opcua::NodeId& id() const noexcept { return id_; }
    skill::Program& program() noexcept { return *program_; }
    void sessionClosed(const opcua::Session& session);

    opcua::DataValue read(const opcua::Session& session, std::uint32_t tag) const override;
    Result<void> write(const opcua::WriteContext& writer, std::uint32_t tag,
                       const opcua::Value& value) override;

private:
    void onTransition(const skill::TransitionEvent& event) override;
    void onStopping(const skill::StoppingEvent& event) override;

    void auditOwnAct(const skill::TransitionEvent& event);
    void raise(opcua::EventEmitter& emitter, const opcua::Event& occurrence);
    Result<void> call(const opcua::Session& session, skill::Method method);
    Result<void> bindNode(opcua::AddressSpace& nodes, const opcua::NodeId& node,
                          NodeRole node_role);
    Result<void> bindMethod(opcua::AddressSpace& nodes, const opcua::NodeId& node,
                            skill::Method method);
    Result<std::vector<opcua::Value>> startWith(const opcua::Session& session,
                                                std::span<const opcua::Value> inputs);
    Result<std::vector<opcua::Value>> check(const opcua::Session& session,
                                            std::span<const opcua::Value> inputs);
    Result<std::vector<opcua::Value>> getExecution(std::span<const opcua::Value> inputs) const;
    /// Arguments of StartWith and Check: the parameters by name, from a KeyValuePair[].
    struct Given {
        skill::ValueMap parameters{};
        skill::ParentExecution parent{};
        skill::ArmPositions starts{};  ///< of Check
    };
    Result<void> takeGiven(const opcua::KeyValue& given, Given& into) const;
    static Result<bool> takeStart(const opcua::KeyValue& given, Given& into);
    Result<Given> givenIn(const opcua::Value& pairs) const;
    std::vector<opcua::KeyValue> pairsOf(const skill::ValueMap& values) const;
    std::string readReason(const opcua::Session& session) const;
    opcua::Value readState(NodeRole node_role) const;
    /// BadNoData before the first transition.
    opcua::DataValue readTransition(NodeRole node_role) const;
    opcua::DataValue readSubState(NodeRole node_role) const;
    /// BadStateNotActive but in Ready after an execution that finished, and in Halted by a force.
    opcua::DataValue readFinish(NodeRole node_role) const;
    opcua::Value readParameter(NodeRole node_role) const;
    /// BadNoData before the first finished execution, and for a result that the last one lacks.
    opcua::DataValue readResult(NodeRole node_role) const;
    Result<void> remember(const opcua::Session& session, Result<void> outcome);

    opcua::NodeId id_;
    SkillContext& context_;
    std::unique_ptr<skill::Program> program_;
    NodeLimits limits_;
    PendingChecks checks_;
    std::vector<opcua::VariableSlot> slots_;  ///< slots of all Variables; never move
};

/// Caller that a Program sees for a session.
skill::Caller callerOf(const opcua::Session& session);

/// The fields of the transition event, in the order of transitionFields().
std::vector<opcua::Value> transitionValues(const skill::TransitionEvent& event);
std::vector<opcua::BrowsePath> transitionFields(const ModelIds& ids);
/// As these, of what begins to come to rest.
std::vector<opcua::Value> stoppingValues(const skill::StoppingEvent& event);
std::vector<opcua::BrowsePath> stoppingFields(const ModelIds& ids);

}  // namespace metier::opcua_skill
