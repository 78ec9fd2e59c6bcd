#include "program_state.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <string>
#include <utility>

#include "metier/opcua_skill/wire_numbers.hpp"

namespace metier::client {
namespace {

using opcua::NodeId;
using opcua::Value;
using opcua_skill::stateId;
using opcua_skill::transitionId;
using skill::State;
using skill::TransitionNumber;

constexpr std::array kStates{State::ready, State::running, State::suspended, State::halted};
constexpr std::uint32_t kTransitions = 9;

std::string textOf(const Value& value) {
    if (const auto text = value.as<opcua::LocalizedText>()) {
        return text->text;
    }
    return value.as<std::string>().value_or("");
}

std::optional<TransitionNumber> transitionOf(std::uint32_t number) {
    return number >= 1 && number <= kTransitions
               ? std::optional(static_cast<TransitionNumber>(number))
               : std::nullopt;
}

template <typename Wanted>
std::optional<TransitionNumber> firstTransition(const Wanted& wanted) {
    for (std::uint32_t number = 1; number <= kTransitions; ++number) {
        if (const auto transition = static_cast<TransitionNumber>(number); wanted(transition)) {
            return transition;
        }
    }
    return std::nullopt;
}

}  // namespace

opcua::Answer<ProgramNodes> findProgramNodes(opcua::Client& client, const NodeId& program) {
    ProgramNodes nodes;
    const std::array<NodeId*, 6> targets{&nodes.state, &nodes.state_id, &nodes.state_number,
                                         &nodes.last,  &nodes.last_id,  &nodes.last_number};
    std::vector<opcua::RelativePath> paths;
    for (const char* variable : {"CurrentState", "LastTransition"}) {
        paths.push_back({program, {{0, variable}}});
        paths.push_back({program, {{0, variable}, {0, "Id"}}});
        paths.push_back({program, {{0, variable}, {0, "Number"}}});
    }
    METIER_ASSIGN(auto found, client.translateMany(std::move(paths)));
    for (std::size_t i = 0; i < targets.size(); ++i) {
        if (found[i]) {
            *targets.at(i) = std::move(*found[i]);
        }
    }
    return nodes;
}

std::vector<opcua::ReadItem> programItems(const ProgramNodes& nodes) {
    return {{nodes.state_id}, {nodes.state_number}, {nodes.state},
            {nodes.last_id},  {nodes.last_number},  {nodes.last}};
}

std::optional<ProgramNow> programNow(const std::vector<opcua::DataValue>& values) {
    const auto state = stateFrom({values[0].value, values[1].value, values[2].value});
    if (!state) {
        return std::nullopt;
    }
    return ProgramNow{*state, transitionFrom({values[3].value, values[4].value, values[5].value})};
}

std::optional<State> stateFrom(const Naming& naming) {
    const auto id = naming.id.as<NodeId>();
    const auto number = naming.number.as<std::uint32_t>().value_or(0);
    const auto name = textOf(naming.name);
    const auto known = [](const auto& matches) -> std::optional<State> {
        const auto* found = std::find_if(kStates.begin(), kStates.end(), matches);
        return found == kStates.end() ? std::nullopt : std::optional(*found);
    };
    if (const auto state = known([&](State one) { return id && *id == stateId(one); })) {
        return state;
    }
    if (const auto state =
            known([&](State one) { return number == static_cast<std::uint32_t>(one); })) {
        return state;
    }
    return known([&](State one) { return name == toString(one); });
}

std::optional<TransitionNumber> transitionFrom(const Naming& naming) {
    const auto id = naming.id.as<NodeId>();
    if (const auto named = firstTransition(
            [&](TransitionNumber number) { return id && *id == transitionId(number); })) {
        return named;
    }
    if (const auto numbered = transitionOf(naming.number.as<std::uint32_t>().value_or(0))) {
        return numbered;
    }
    const auto name = textOf(naming.name);
    return firstTransition([&](TransitionNumber number) { return toString(number) == name; });
}

std::optional<TransitionNumber> transitionBetween(State from, State to) {
    return firstTransition([&](TransitionNumber number) {
        return fromState(number) == from && toState(number) == to;
    });
}

}  // namespace metier::client
