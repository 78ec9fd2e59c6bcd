#pragma once

#include <open62541/plugin/eventloop.h>

#include <cstdint>
#include <string>
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

/// The parameters of a callback, each a string or a port number; valid while the object lives.
class CallbackParameters {
public:
    CallbackParameters& address(const char* key, std::string value);
    CallbackParameters& port(const char* key, std::uint16_t value);
    const UA_KeyValueMap& map();

private:
    std::string address_;
    UA_String address_view_{};
    std::uint16_t port_ = 0;
    std::vector<UA_KeyValuePair> pairs_;
    UA_KeyValueMap map_{};
};

}  // namespace metier::opcua
