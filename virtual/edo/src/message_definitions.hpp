#pragma once

#include <map>
#include <string>
#include <vector>

#include "message_types.hpp"

namespace metier::virtual_edo {

using Definitions = std::map<std::string, std::vector<Field>, std::less<>>;

/// Every message and service type of one release.
Definitions definitionsFor(const Software& software);

}  // namespace metier::virtual_edo
