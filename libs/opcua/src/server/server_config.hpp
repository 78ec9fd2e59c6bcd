#pragma once

#include <open62541/server.h>

#include "common/peer_check.hpp"
#include "metier/opcua/server.hpp"

namespace metier::opcua {

/// Errors: invalid_argument, naming the option; not_found (NodeSet).
Result<> checkOptions(const ServerOptions& options);

/// Sets what the options say. The logger and the event loop must be set already.
/// \param peers for a closed server; must outlive it
/// Errors: internal (the stack); invalid_argument (the identity).
Result<> applyOptions(const ServerOptions& options, PeerCheck* peers, UA_ServerConfig& config);

/// The URL a client on this machine uses. \param port the real one
std::string endpointUrlOf(const std::string& address, std::uint16_t port);

}  // namespace metier::opcua
