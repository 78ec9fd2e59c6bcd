#pragma once

#include <optional>
#include <vector>

#include "metier/opcua/client.hpp"
#include "metier/skill/state.hpp"

namespace metier::client {

/// The nodes that show what a Program does. OPC 10000-10 makes only CurrentState with its Id
/// mandatory; a node that the server lacks is null.
struct ProgramNodes {
    opcua::NodeId state;  ///< CurrentState, as the next
    opcua::NodeId state_id;
    opcua::NodeId state_number;
    opcua::NodeId last;  ///< LastTransition, as the next
    opcua::NodeId last_id;
    opcua::NodeId last_number;
};

/// Errors: those of the server; none for nodes that are not there.
opcua::Answer<ProgramNodes> findProgramNodes(opcua::Client& client, const opcua::NodeId& program);

/// State and last transition of a Program.
struct ProgramNow {
    skill::State state = skill::State::halted;
    std::optional<skill::TransitionNumber> last{};  ///< none: not published, or none yet
};

/// Nodes whose values programNow() needs, in its order.
std::vector<opcua::ReadItem> programItems(const ProgramNodes& nodes);
/// \return nothing if the values name no state of a Program
std::optional<ProgramNow> programNow(const std::vector<opcua::DataValue>& values);

/// The three ways to name a state or a transition, in the order of trust: the NodeId of namespace
/// 0, the number, the name. Each may be of any type, or Null.
struct Naming {
    const opcua::Value& id;
    const opcua::Value& number;
    const opcua::Value& name;
};

std::optional<skill::State> stateFrom(const Naming& naming);
std::optional<skill::TransitionNumber> transitionFrom(const Naming& naming);

/// The transition from one state to another; nothing if a Program has none.
std::optional<skill::TransitionNumber> transitionBetween(skill::State from, skill::State to);

}  // namespace metier::client
