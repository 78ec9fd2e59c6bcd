#pragma once

#include <string>
#include <string_view>

namespace metier::opcua {

/// Text from the network made fit for logs, terminals and pages: well-formed UTF-8 without
/// control characters. What does not fit becomes U+FFFD; all else is kept byte for byte.
///
/// Threading: any; pure.
std::string sanitise(std::string_view text);

}  // namespace metier::opcua
