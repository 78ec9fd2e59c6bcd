#include "model_ids.hpp"

#include <algorithm>
#include <array>
#include <string>
#include <utility>

namespace metier::opcua_skill {

namespace {

struct SubStateRow {
    skill::SubState sub_state;
    std::uint32_t number;
    skill::State state;
};

constexpr std::array kSubStates{
    SubStateRow{skill::SubState::ready_not_configured, 121, skill::State::ready},
    SubStateRow{skill::SubState::ready_configured, 122, skill::State::ready},
    SubStateRow{skill::SubState::executing, 131, skill::State::running},
    SubStateRow{skill::SubState::stopping, 132, skill::State::running},
    SubStateRow{skill::SubState::halted_by_client, 111, skill::State::halted},
    SubStateRow{skill::SubState::halted_error, 112, skill::State::halted},
    SubStateRow{skill::SubState::halted_force, 113, skill::State::halted},
    SubStateRow{skill::SubState::halted_owner_lost, 114, skill::State::halted},
    SubStateRow{skill::SubState::halted_device_lost, 115, skill::State::halted},
    SubStateRow{skill::SubState::halted_limit, 116, skill::State::halted},
};

const SubStateRow* rowOf(skill::SubState sub_state) {
    const auto* row =
        std::find_if(kSubStates.begin(), kSubStates.end(),
                     [&](const SubStateRow& entry) { return entry.sub_state == sub_state; });
    return row == kSubStates.end() ? nullptr : row;
}

const opcua::NodeId kFiniteStateMachineType{0, 2771U};

/// A state of FinishStateMachineType; null if the server does not have that type.
opcua::NodeId finishState(const opcua::AddressSpace& nodes, const std::string& name) {
    const auto robotics = nodes.namespaceIndex(kRoboticsUri);
    const auto machine = robotics ? typeDirectlyBelow(nodes, kFiniteStateMachineType,
                                                      {*robotics, "FinishStateMachineType"})
                                  : fail(robotics.error());
    const auto state = machine ? nodes.find(*machine, {*robotics, name}) : machine;
    return state.value_or(opcua::NodeId());
}

}  // namespace

opcua::NodeId stateId(skill::State state) {
    constexpr std::array kIds{2406U, 2400U, 2402U, 2404U};  // in the order of skill::State
    const auto index =
        static_cast<std::uint32_t>(state) - static_cast<std::uint32_t>(skill::State::halted);
    return {0, kIds.at(index)};
}

opcua::NodeId transitionId(skill::TransitionNumber number) {
    constexpr std::uint32_t kHaltedToReady = 2408;  // the others follow in the order of numbers
    return {0, kHaltedToReady + 2 * (static_cast<std::uint32_t>(number) - 1)};
}

std::uint32_t numberOf(skill::SubState sub_state) {
    const auto* row = rowOf(sub_state);
    return row == nullptr ? 0 : row->number;
}

skill::State stateOf(skill::SubState sub_state) {
    const auto* row = rowOf(sub_state);
    return row == nullptr ? skill::State::suspended : row->state;
}

Result<ModelIds> ModelIds::of(const opcua::AddressSpace& nodes) {
    ModelIds ids;
    const auto device = nodes.namespaceIndex(kDeviceUri);
    const auto metier = nodes.namespaceIndex(kMetierUri);
    if (!device || !metier) {
        return fail(Errc::not_found, "skills need the NodeSets device and metier");
    }
    ids.device = *device;
    ids.metier = *metier;
    ids.skill_type = opcua::NodeId(*device, kSkillTypeId);
    METIER_ASSIGN(ids.transition_event_type,
                  typeDirectlyBelow(nodes, opcua::ids::kProgramTransitionEventType,
                                    {*device, "SkillTransitionEventType"}));
    for (const auto& row : kSubStates) {
        const auto machine_type = std::string(skill::toString(row.state)) + "SubStateMachineType";
        METIER_ASSIGN(auto machine,
                      typeDirectlyBelow(nodes, kFiniteStateMachineType, {*metier, machine_type}));
        METIER_ASSIGN(auto state,
                      nodes.find(machine, {*metier, std::string(skill::toString(row.sub_state))}));
        ids.sub_states.emplace(row.sub_state, state);
    }
    ids.success = finishState(nodes, "Success");
    ids.force_exceeded = finishState(nodes, "ForceExceeded");
    return ids;
}

Result<opcua::NodeId> typeDirectlyBelow(const opcua::AddressSpace& nodes, const opcua::NodeId& base,
                                        const opcua::QualifiedName& name) {
    METIER_ASSIGN(const auto types, nodes.browse(base, {opcua::ids::kHasSubtype}));
    for (const auto& type : types) {
        if (type.browse_name == name) {
            return type.target;
        }
    }
    return fail(Errc::not_found, "the server has no type " + name.name);
}

}  // namespace metier::opcua_skill
