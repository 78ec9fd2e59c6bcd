#pragma once

#include <open62541/server.h>

#include <string>
#include <vector>

#include "metier/base/error.hpp"

namespace metier::opcua {

/// Errors: not_found, naming it and those there are.
Result<> checkNodesets(const std::vector<std::string>& names);

/// Adds the named NodeSets and all of the skill model that they stand on, always in one order:
/// the compiled data types of NodeSets exist once per process and hold namespace indices.
/// Before the server runs. Errors: not_found (as above), internal (the stack).
Result<> loadNodesets(UA_Server* server, const std::vector<std::string>& names);

}  // namespace metier::opcua
