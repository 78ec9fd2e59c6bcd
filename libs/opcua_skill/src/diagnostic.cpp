#include "diagnostic.hpp"

#include <utility>

#include "metier/opcua_skill/values.hpp"

namespace metier::opcua_skill {

namespace {

opcua::NodeId sessionOf(const std::string& text) {
    auto id = opcua::NodeId::parse(text);
    return id ? std::move(*id) : opcua::NodeId();
}

opcua::StatusCode statusCodeOf(const Result<void>& outcome) {
    return outcome ? opcua::status::kGood : opcua::statusFrom(outcome.error().code);
}

/// Null for what has not happened yet.
UtcTime timeOrNull(UtcTime time) {
    return time == UtcTime{} ? UtcTime::min() : time;
}

}  // namespace

opcua::ProgramDiagnostic toOpcua(const skill::Diagnostic& diagnostic) {
    opcua::ProgramDiagnostic result;
    result.create_session_id = sessionOf(diagnostic.create_session_id);
    result.create_client_name = diagnostic.create_client_name;
    result.invocation_creation_time = timeOrNull(diagnostic.invocation_creation_time);
    result.last_transition_time = timeOrNull(diagnostic.last_transition_time);
    result.last_method_call = diagnostic.last_method_call;
    result.last_method_session_id = sessionOf(diagnostic.last_method_session_id);
    for (const auto& [name, value] : diagnostic.last_method_inputs) {
        auto shape = shapeOf(skill::typeOf(value));
        result.last_method_input_arguments.push_back(
            {name, std::move(shape.data_type), shape.value_rank, {}, {}});
        result.last_method_input_values.push_back(toOpcua(value));
    }
    result.last_method_call_time = timeOrNull(diagnostic.last_method_call_time);
    result.last_method_return_status = statusCodeOf(diagnostic.last_method_status);
    return result;
}

opcua::Value readDiagnostic(const skill::Diagnostic& diagnostic, DiagnosticItem item) {
    using opcua::Value;
    switch (item) {
        case DiagnosticItem::whole:
            return Value::of(toOpcua(diagnostic));
        case DiagnosticItem::create_session_id:
            return Value::of(sessionOf(diagnostic.create_session_id));
        case DiagnosticItem::create_client_name:
            return Value::of(diagnostic.create_client_name);
        case DiagnosticItem::invocation_creation_time:
            return Value::of(timeOrNull(diagnostic.invocation_creation_time));
        case DiagnosticItem::last_transition_time:
            return Value::of(timeOrNull(diagnostic.last_transition_time));
        case DiagnosticItem::last_method_call:
            return Value::of(diagnostic.last_method_call);
        case DiagnosticItem::last_method_session_id:
            return Value::of(sessionOf(diagnostic.last_method_session_id));
        case DiagnosticItem::last_method_input_arguments:
            return Value::of(toOpcua(diagnostic).last_method_input_arguments);
        case DiagnosticItem::last_method_output_arguments:
            return Value::of(std::vector<opcua::Argument>());
        case DiagnosticItem::last_method_input_values:
            return Value::ofMixed(toOpcua(diagnostic).last_method_input_values);
        case DiagnosticItem::last_method_output_values:
            return Value::ofMixed({});
        case DiagnosticItem::last_method_call_time:
            return Value::of(timeOrNull(diagnostic.last_method_call_time));
        case DiagnosticItem::last_method_return_status:
            return Value::of(statusCodeOf(diagnostic.last_method_status));
    }
    return {};
}

}  // namespace metier::opcua_skill
