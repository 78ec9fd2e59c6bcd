#include "metier/opcua_skill/values.hpp"
#include "skill_node.hpp"

namespace metier::opcua_skill {

namespace {

using opcua::LocalizedText;
using opcua::QualifiedName;
using opcua::Value;

/// LocalizedText, Id, Name and Number of a state or transition.
template <typename Named>
void appendNamed(std::vector<Value>& values, Named named, const opcua::NodeId& id) {
    const std::string name(skill::toString(named));
    values.push_back(Value::of(LocalizedText{"en", name}));
    values.push_back(Value::of(id));
    values.push_back(Value::of(QualifiedName{0, name}));
    values.push_back(Value::of(static_cast<std::uint32_t>(named)));
}

}  // namespace

std::vector<opcua::BrowsePath> transitionFields(const ModelIds& ids) {
    std::vector<opcua::BrowsePath> paths;
    for (const char* name : {"FromState", "ToState", "Transition"}) {
        paths.push_back({{0, name}});
        for (const char* part : {"Id", "Name", "Number"}) {
            paths.push_back({{0, name}, {0, part}});
        }
    }
    paths.push_back({{0, "Transition"}, {0, "TransitionTime"}});
    paths.push_back({{0, "IntermediateResult"}});
    paths.push_back({{ids.device, "ExecutionId"}});
    paths.push_back({{ids.device, "Reason"}});
    paths.push_back({{ids.device, "ReasonText"}});
    return paths;
}

std::vector<Value> transitionValues(const skill::TransitionEvent& event) {
    std::vector<Value> values;
    values.reserve(17);
    appendNamed(values, event.from, stateId(event.from));
    appendNamed(values, event.to, stateId(event.to));
    appendNamed(values, event.number, transitionId(event.number));
    values.push_back(Value::of(event.time));
    values.push_back(toOpcua(event.intermediate_result));
    values.push_back(Value::of(event.execution_id));
    values.push_back(Value::of(static_cast<std::int32_t>(event.reason)));
    values.push_back(Value::of(event.reason_text));
    return values;
}

std::vector<opcua::BrowsePath> stoppingFields(const ModelIds& ids) {
    return {{{ids.metier, "ExecutionId"}},
            {{ids.metier, "StateAtRest"}},
            {{ids.metier, "Reason"}},
            {{ids.metier, "ReasonText"}}};
}

std::vector<Value> stoppingValues(const skill::StoppingEvent& event) {
    return {Value::of(event.execution_id), Value::of(static_cast<std::uint32_t>(event.to)),
            Value::of(static_cast<std::int32_t>(event.reason)), Value::of(event.reason_text)};
}

}  // namespace metier::opcua_skill
