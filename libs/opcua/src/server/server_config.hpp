#pragma once

#include <open62541/server.h>

#include <string>
#include <vector>

#include "common/peer_check.hpp"
#include "metier/opcua/server.hpp"

namespace metier::opcua {

/// Errors: invalid_argument, naming the option; not_found (NodeSet).
Result<> checkOptions(const ServerOptions& options);

/// Sets what the options say. The logger and the event loop must be set already.
/// \param peers for a closed server; must outlive it
/// Errors: internal (the stack); invalid_argument (the identity).
Result<> applyOptions(const ServerOptions& options, PeerCheck* peers, UA_ServerConfig& config);

/// Profiles for ServerProfileArray. The stack's own claim of StandardUA2017, which needs X.509
/// users and Cancel, and of NodeManagement is not true of our servers. Source: OPC 10000-7
/// (1.04), 6.6.67 Micro, 6.6.69 Embedded, 6.6.70 Standard.
std::vector<std::string> profilesOf(const ServerOptions& options);

/// The URL a client on this machine uses. \param port the real one
std::string endpointUrlOf(const std::string& address, std::uint16_t port);

}  // namespace metier::opcua
