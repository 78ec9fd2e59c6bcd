#pragma once

#include "known.hpp"
#include "metier/opcua/client.hpp"

namespace metier::hostile {

/// Targets for hostile clients: all nodes below the Objects folder, each once. Throws if the server
/// does not return them.
AddressMap survey(opcua::Client& client);

}  // namespace metier::hostile
