#pragma once

#include <string>
#include <string_view>

namespace metier::opcua {

/// Makes text from the network fit for logs, terminals and pages: well-formed UTF-8 without control
/// characters. Bytes that do not fit become U+FFFD; all else is kept byte for byte.
///
/// Threading: any; pure.
std::string sanitise(std::string_view text);

}  // namespace metier::opcua
