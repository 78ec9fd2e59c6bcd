#pragma once

#include "metier/base/error.hpp"
#include "metier/composition/used_skill.hpp"
#include "metier/opcua/client.hpp"

namespace metier::client {

/// Asks a server for its time, several times, and trusts the quickest answer: its clock was read
/// within that round trip, so half of it is the uncertainty.
/// Errors: the server's, timeout, connection_lost. Threads: any; waits for the server.
Result<composition::ClockOffset> clockOffsetOf(opcua::Client& client);

}  // namespace metier::client
