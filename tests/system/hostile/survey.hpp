#pragma once

#include "known.hpp"
#include "metier/opcua/client.hpp"

namespace metier::hostile {

/// What hostile clients may aim at: all that is below the Objects folder, each node once.
/// Throws if the server does not tell it.
AddressMap survey(opcua::Client& client);

}  // namespace metier::hostile
