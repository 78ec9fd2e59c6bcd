#pragma once

#include <array>
#include <map>
#include <string>
#include <vector>

#include "metier/client/skill_finder.hpp"
#include "metier/opcua/client.hpp"
#include "metier/skill/field.hpp"
#include "metier/skill/state.hpp"

namespace metier::client {

inline constexpr const char* kDeviceNamespace = "https://fortiss.org/UA/Device/";

/// A parameter or result together with its node.
struct FieldNode {
    skill::Field field;
    opcua::NodeId node;
};

/// The nodes below one skill that a client uses.
struct SkillNodes {
    std::array<opcua::NodeId, 6> methods;  ///< in the order of skill::Method
    opcua::NodeId start_with;              ///< null if the server has none, as the next
    opcua::NodeId check;
    opcua::NodeId get_execution;
    opcua::NodeId state_number;
    opcua::NodeId reason_text;  ///< null if the server has none, as the next
    opcua::NodeId execution_id;
    /// Null if the server keeps no records for clients; then it takes no parent of a start, either.
    opcua::NodeId records;
    bool suspendable = true;
    std::vector<FieldNode> parameters;
    std::vector<FieldNode> results;
};

std::vector<skill::Field> fieldsOf(const std::vector<FieldNode>& nodes);

/// Finds them. Errors: not_found if the object lacks what every Program has.
opcua::Answer<SkillNodes> readSkillNodes(opcua::Client& client, const SkillAddress& address);

}  // namespace metier::client
