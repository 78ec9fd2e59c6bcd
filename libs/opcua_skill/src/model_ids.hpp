#pragma once

#include <cstdint>
#include <map>

#include "metier/base/error.hpp"
#include "metier/opcua/address_space.hpp"
#include "metier/opcua_skill/namespaces.hpp"
#include "metier/opcua_skill/wire_numbers.hpp"
#include "metier/skill/state.hpp"

namespace metier::opcua_skill {

/// SkillType in the Device namespace (published 2020).
inline constexpr std::uint32_t kSkillTypeId = 15034;
/// DeviceSet in the namespace of OPC 10000-100.
inline constexpr std::uint32_t kDeviceSetId = 5001;
/// MotorType in the namespace of OPC 40010-1.
inline constexpr std::uint32_t kMotorTypeId = 1019;

/// Ids of the model's nodes with the namespace indices of one server.
struct ModelIds {
    std::uint16_t device = 0;
    std::uint16_t metier = 0;
    opcua::NodeId skill_type;
    opcua::NodeId transition_event_type;
    std::map<skill::SubState, opcua::NodeId> sub_states;
    /// States of FinishStateMachineType; null where the server does not have it.
    opcua::NodeId success;
    opcua::NodeId force_exceeded;

    /// Errors: not_found, naming what the server's NodeSets lack.
    static Result<ModelIds> of(const opcua::AddressSpace& nodes);
};

/// The type of that name directly below `base`.
/// Errors: not_found.
Result<opcua::NodeId> typeDirectlyBelow(const opcua::AddressSpace& nodes, const opcua::NodeId& base,
                                        const opcua::QualifiedName& name);

/// The child of `spec.node.parent` that has that BrowseName; made if there is none. Server's
/// thread. Errors: those of AddressSpace::addObject().
inline Result<opcua::NodeId> foundOrAdded(opcua::AddressSpace& nodes,
                                          const opcua::ObjectSpec& spec) {
    if (auto found = nodes.find(spec.node.parent, spec.node.browse_name)) {
        return found;
    }
    return nodes.addObject(spec);
}

/// The number that the model gives to a sub-state; 0 for none.
std::uint32_t numberOf(skill::SubState sub_state);
/// The state that a sub-state belongs to; nothing but `none` belongs to Suspended.
skill::State stateOf(skill::SubState sub_state);

}  // namespace metier::opcua_skill
