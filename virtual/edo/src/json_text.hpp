#pragma once

#include <string>
#include <string_view>

#include "message_types.hpp"

namespace metier::virtual_edo {

/// The JSON of a text from outside; discarded (neither object nor anything else) if it is none or
/// is nested deeper than any message.
Json parseJson(std::string_view text);

/// Plain ASCII, as rosbridge sends.
std::string toText(const Json& message);

}  // namespace metier::virtual_edo
