// The one structure of Programs that clients read as a whole.

#include "common/native.hpp"

namespace metier::opcua {

ProgramDiagnostic fromNative(const UA_ProgramDiagnostic2DataType& diagnostic) {
    return {
        fromNative(diagnostic.createSessionId),
        textFrom(diagnostic.createClientName),
        timeFrom(diagnostic.invocationCreationTime),
        timeFrom(diagnostic.lastTransitionTime),
        textFrom(diagnostic.lastMethodCall),
        fromNative(diagnostic.lastMethodSessionId),
        vectorFrom<Argument>(diagnostic.lastMethodInputArguments,
                             diagnostic.lastMethodInputArgumentsSize),
        vectorFrom<Argument>(diagnostic.lastMethodOutputArguments,
                             diagnostic.lastMethodOutputArgumentsSize),
        vectorFrom<Value>(diagnostic.lastMethodInputValues, diagnostic.lastMethodInputValuesSize),
        vectorFrom<Value>(diagnostic.lastMethodOutputValues, diagnostic.lastMethodOutputValuesSize),
        timeFrom(diagnostic.lastMethodCallTime),
        StatusCode(diagnostic.lastMethodReturnStatus)};
}

void toNative(const ProgramDiagnostic& diagnostic, UA_ProgramDiagnostic2DataType& target) {
    toNative(diagnostic.create_session_id, target.createSessionId);
    toNative(diagnostic.create_client_name, target.createClientName);
    target.invocationCreationTime = nativeTime(diagnostic.invocation_creation_time);
    target.lastTransitionTime = nativeTime(diagnostic.last_transition_time);
    toNative(diagnostic.last_method_call, target.lastMethodCall);
    toNative(diagnostic.last_method_session_id, target.lastMethodSessionId);
    toNative(diagnostic.last_method_input_arguments, target.lastMethodInputArguments,
             target.lastMethodInputArgumentsSize);
    toNative(diagnostic.last_method_output_arguments, target.lastMethodOutputArguments,
             target.lastMethodOutputArgumentsSize);
    toNative(diagnostic.last_method_input_values, target.lastMethodInputValues,
             target.lastMethodInputValuesSize);
    toNative(diagnostic.last_method_output_values, target.lastMethodOutputValues,
             target.lastMethodOutputValuesSize);
    target.lastMethodCallTime = nativeTime(diagnostic.last_method_call_time);
    target.lastMethodReturnStatus = diagnostic.last_method_return_status.value();
}

}  // namespace metier::opcua
