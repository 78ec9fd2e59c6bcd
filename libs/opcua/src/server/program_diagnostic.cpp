// The one structure of Programs that clients read as a whole.

#include "common/convert.hpp"

namespace metier::opcua {

namespace {

std::vector<Argument> argumentsFrom(const UA_Argument* arguments, std::size_t size) {
    std::vector<Argument> result;
    result.reserve(size);
    for (std::size_t i = 0; i < size; ++i) {
        result.push_back(fromNative(arguments[i]));
    }
    return result;
}

std::vector<Value> valuesFrom(const UA_Variant* values, std::size_t size) {
    std::vector<Value> result;
    result.reserve(size);
    for (std::size_t i = 0; i < size; ++i) {
        result.push_back(ValueAccess::copyOf(values[i]));
    }
    return result;
}

/// Zeroed memory of the stack for an array inside a structure.
template <typename Native>
Native* newElements(std::size_t size, const UA_DataType& type) {
    auto* elements = static_cast<Native*>(UA_Array_new(size, &type));
    checkAllocated(elements == nullptr ? UA_STATUSCODE_BADOUTOFMEMORY : UA_STATUSCODE_GOOD);
    return elements;
}

void setArguments(const std::vector<Argument>& arguments, UA_Argument*& target, std::size_t& size) {
    target = newElements<UA_Argument>(arguments.size(), UA_TYPES[UA_TYPES_ARGUMENT]);
    size = arguments.size();
    for (std::size_t i = 0; i < arguments.size(); ++i) {
        toNative(arguments[i], target[i]);
    }
}

void setValues(const std::vector<Value>& values, UA_Variant*& target, std::size_t& size) {
    target = newElements<UA_Variant>(values.size(), UA_TYPES[UA_TYPES_VARIANT]);
    size = values.size();
    for (std::size_t i = 0; i < values.size(); ++i) {
        checkAllocated(UA_Variant_copy(&ValueAccess::native(values[i]), &target[i]));
    }
}

}  // namespace

ProgramDiagnostic fromNative(const UA_ProgramDiagnostic2DataType& diagnostic) {
    return {
        fromNative(diagnostic.createSessionId),
        textFrom(diagnostic.createClientName),
        timeFrom(diagnostic.invocationCreationTime),
        timeFrom(diagnostic.lastTransitionTime),
        textFrom(diagnostic.lastMethodCall),
        fromNative(diagnostic.lastMethodSessionId),
        argumentsFrom(diagnostic.lastMethodInputArguments, diagnostic.lastMethodInputArgumentsSize),
        argumentsFrom(diagnostic.lastMethodOutputArguments,
                      diagnostic.lastMethodOutputArgumentsSize),
        valuesFrom(diagnostic.lastMethodInputValues, diagnostic.lastMethodInputValuesSize),
        valuesFrom(diagnostic.lastMethodOutputValues, diagnostic.lastMethodOutputValuesSize),
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
    setArguments(diagnostic.last_method_input_arguments, target.lastMethodInputArguments,
                 target.lastMethodInputArgumentsSize);
    setArguments(diagnostic.last_method_output_arguments, target.lastMethodOutputArguments,
                 target.lastMethodOutputArgumentsSize);
    setValues(diagnostic.last_method_input_values, target.lastMethodInputValues,
              target.lastMethodInputValuesSize);
    setValues(diagnostic.last_method_output_values, target.lastMethodOutputValues,
              target.lastMethodOutputValuesSize);
    target.lastMethodCallTime = nativeTime(diagnostic.last_method_call_time);
    target.lastMethodReturnStatus = diagnostic.last_method_return_status.value();
}

}  // namespace metier::opcua
