#pragma once

#include <vector>

#include "metier/cell/limits.hpp"
#include "metier/opcua/server.hpp"

namespace metier::server {

/// Limits for the clients of a server: those of its cell file, else the defaults. More
/// Sessions than Connections bring as many Connections with them.
opcua::ServerLimits limitsOf(const std::vector<cell::Limit>& limits);

}  // namespace metier::server
