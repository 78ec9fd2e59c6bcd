#pragma once

#include <open62541/client.h>
#include <open62541/server.h>

#include "common/peer_check.hpp"
#include "metier/base/error.hpp"
#include "metier/opcua/security.hpp"

namespace metier::opcua {

/// SecurityPolicies and Endpoints of a closed server, None for discovery alone.
/// \param peers must outlive the server
/// Errors: invalid_argument (the identity).
Result<> addSecurity(const Credentials& credentials, PeerCheck& peers, UA_ServerConfig& config);
/// Gives the policies of a closed server another certificate and key.
/// Errors: invalid_argument (the identity).
Result<> replaceIdentity(const security::Identity& identity, UA_ServerConfig& config);
/// The Endpoint of a lab: without security, for everything.
Result<> addNoSecurity(UA_ServerConfig& config);

/// Signs and encrypts, with the strongest policy that metier has.
/// \param peers must outlive the client
/// Errors: invalid_argument (the identity).
Result<> addSecurity(const Credentials& credentials, PeerCheck& peers, UA_ClientConfig& config);

}  // namespace metier::opcua
