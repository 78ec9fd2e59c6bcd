#pragma once

#include <open62541/plugin/eventloop.h>

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "metier/base/error.hpp"

namespace metier::opcua {

/// Parameters that the stack gives when it opens a connection.
struct TcpParameters {
    /// Addresses to listen on (none: all), or the one to connect to
    std::vector<std::string> addresses;
    std::uint16_t port = 0;
    bool listen = false;
    bool validate = false;  ///< check the parameters, open nothing
};

/// `reuse` is not read: a listening socket always survives a restart and never shares its port.
/// Errors: invalid_argument (no port, an address that is no string, nowhere to connect to).
Result<TcpParameters> readTcpParameters(const UA_KeyValueMap* map);

/// A parameter of a callback; valid as long as key and value.
UA_KeyValuePair parameterOf(const char* key, UA_String& value);
UA_KeyValuePair parameterOf(const char* key, UA_UInt16& value);

/// The stack's strings are bytes and never const; it does not change these.
UA_String asStackString(std::string_view text);

}  // namespace metier::opcua
