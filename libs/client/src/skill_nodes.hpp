#pragma once

#include <array>
#include <map>
#include <string>
#include <vector>

#include "device_lock.hpp"
#include "metier/client/lack.hpp"
#include "metier/client/skill_finder.hpp"
#include "metier/opcua/client.hpp"
#include "metier/skill/field.hpp"
#include "metier/skill/state.hpp"
#include "program_state.hpp"

namespace metier::client {

/// A parameter or result together with its node.
struct FieldNode {
    skill::Field field;
    opcua::NodeId node;
    /// Data type for which the type of `field` stands, see standInFor(); null: it is that type.
    opcua::NodeId foreign_type{};

    /// A value of it as it was sent; Null if it has another type.
    skill::Value received(const opcua::Value& value) const;
    /// A value for it as it is sent. Errors: those of toForeign(), with the field's name.
    Result<opcua::Value> sent(const skill::Value& value) const;
};

/// The nodes below one skill that a client uses.
struct SkillNodes {
    /// In the order of skill::Method; null if the skill lacks it, which only Start never does.
    std::array<opcua::NodeId, 6> methods;
    ProgramNodes program;
    opcua::NodeId start_with;  ///< null if the server has none, as the next
    opcua::NodeId check;
    opcua::NodeId get_execution;
    opcua::NodeId reason_text;
    opcua::NodeId execution_id;
    /// Null if the server keeps no records for clients; then it takes no parent of a start, either.
    opcua::NodeId records;
    LockNodes lock;  ///< of the skill's device; looked for only if the server names no executions
    bool suspendable = true;
    bool runs_others = false;  ///< it has steps, or used skills below it
    std::vector<FieldNode> parameters;
    std::vector<FieldNode> results;

    /// Whether the server answers for executions by their names. One that does not is not ours:
    /// what it runs is known only by looking at the skill's state.
    bool knowsExecutions() const { return !start_with.isNull() && !get_execution.isNull(); }
    /// What a run cannot have.
    std::vector<Lack> lacks() const;
};

std::vector<skill::Field> fieldsOf(const std::vector<FieldNode>& nodes);

/// The method of that name among the references from a skill, in the lowest namespace that has one;
/// null: none.
const opcua::Reference* methodAmong(const std::vector<opcua::Reference>& children,
                                    skill::Method method);

/// Finds them. Errors: not_found if the object lacks what every Program has.
opcua::Answer<SkillNodes> readSkillNodes(opcua::Client& client, const SkillAddress& address);

}  // namespace metier::client
