#include "diagnostic.hpp"

#include <array>
#include <utility>

#include "metier/opcua_skill/values.hpp"

namespace metier::opcua_skill {

namespace {

using opcua::Value;

template <auto kMember>
Value part(const opcua::ProgramDiagnostic& diagnostic) {
    if constexpr (requires { Value::of(diagnostic.*kMember); }) {
        return Value::of(diagnostic.*kMember);
    } else {
        return Value::ofMixed(diagnostic.*kMember);
    }
}

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

std::span<const DiagnosticItem> diagnosticItems() {
    using Diagnostic = opcua::ProgramDiagnostic;
    static constexpr std::array kItems{
        DiagnosticItem{"", [](const Diagnostic& diagnostic) { return Value::of(diagnostic); }},
        DiagnosticItem{"/CreateSessionId", part<&Diagnostic::create_session_id>},
        DiagnosticItem{"/CreateClientName", part<&Diagnostic::create_client_name>},
        DiagnosticItem{"/InvocationCreationTime", part<&Diagnostic::invocation_creation_time>},
        DiagnosticItem{"/LastTransitionTime", part<&Diagnostic::last_transition_time>},
        DiagnosticItem{"/LastMethodCall", part<&Diagnostic::last_method_call>},
        DiagnosticItem{"/LastMethodSessionId", part<&Diagnostic::last_method_session_id>},
        DiagnosticItem{"/LastMethodInputArguments", part<&Diagnostic::last_method_input_arguments>},
        DiagnosticItem{"/LastMethodOutputArguments",
                       part<&Diagnostic::last_method_output_arguments>},
        DiagnosticItem{"/LastMethodInputValues", part<&Diagnostic::last_method_input_values>},
        DiagnosticItem{"/LastMethodOutputValues", part<&Diagnostic::last_method_output_values>},
        DiagnosticItem{"/LastMethodCallTime", part<&Diagnostic::last_method_call_time>},
        DiagnosticItem{"/LastMethodReturnStatus", part<&Diagnostic::last_method_return_status>},
    };
    return kItems;
}

}  // namespace metier::opcua_skill
