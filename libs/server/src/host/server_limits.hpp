#pragma once

#include <vector>

#include "metier/cell/limits.hpp"
#include "metier/opcua/server.hpp"

namespace metier::server {

/// What clients may ask of a server: what its cell file says, else what it is by default. More
/// Sessions than Connections bring as many Connections with them.
opcua::ServerLimits limitsOf(const std::vector<cell::Limit>& limits);

}  // namespace metier::server
