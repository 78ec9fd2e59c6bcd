#include "tcp_parameters.hpp"

#include <span>
#include <string_view>
#include <utility>

namespace metier::opcua {

namespace {

UA_KeyValuePair parameterOf(const char* key, void* value, std::size_t type) {
    UA_KeyValuePair pair{{0, asStackString(key)}, {}};
    UA_Variant_setScalar(&pair.value, value, &UA_TYPES[type]);
    return pair;
}

UA_QualifiedName keyOf(const char* name) {
    return {0, asStackString(name)};
}

bool readFlag(const UA_KeyValueMap* map, const char* name) {
    const auto* flag = static_cast<const UA_Boolean*>(
        UA_KeyValueMap_getScalar(map, keyOf(name), &UA_TYPES[UA_TYPES_BOOLEAN]));
    return flag != nullptr && *flag;
}

Result<std::vector<std::string>> readAddresses(const UA_KeyValueMap* map) {
    std::vector<std::string> addresses;
    const auto* value = UA_KeyValueMap_get(map, keyOf("address"));
    if (value == nullptr || UA_Variant_isEmpty(value)) {
        return addresses;
    }
    if (value->type != &UA_TYPES[UA_TYPES_STRING]) {
        return fail(Errc::invalid_argument, "TCP parameter address is not a string");
    }
    const auto count = UA_Variant_isScalar(value) ? 1 : value->arrayLength;
    for (const auto& text : std::span(static_cast<const UA_String*>(value->data), count)) {
        addresses.emplace_back(text.data, text.data + text.length);
    }
    return addresses;
}

}  // namespace

Result<TcpParameters> readTcpParameters(const UA_KeyValueMap* map) {
    const auto* port = static_cast<const UA_UInt16*>(
        UA_KeyValueMap_getScalar(map, keyOf("port"), &UA_TYPES[UA_TYPES_UINT16]));
    if (port == nullptr) {
        return fail(Errc::invalid_argument, "TCP parameter port is missing");
    }
    METIER_ASSIGN(auto addresses, readAddresses(map));
    TcpParameters parameters{.addresses = std::move(addresses),
                             .port = *port,
                             .listen = readFlag(map, "listen"),
                             .validate = readFlag(map, "validate")};
    if (!parameters.listen && parameters.addresses.size() != 1) {
        return fail(Errc::invalid_argument, "TCP parameter address must name one host");
    }
    return parameters;
}

UA_KeyValuePair parameterOf(const char* key, UA_String& value) {
    return parameterOf(key, &value, UA_TYPES_STRING);
}

UA_KeyValuePair parameterOf(const char* key, UA_UInt16& value) {
    return parameterOf(key, &value, UA_TYPES_UINT16);
}

UA_String asStackString(std::string_view text) {
    // NOLINTNEXTLINE(cppcoreguidelines-pro-type-*-cast): see the header
    return {text.size(), reinterpret_cast<UA_Byte*>(const_cast<char*>(text.data()))};
}

}  // namespace metier::opcua
