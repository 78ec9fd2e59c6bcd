#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "message_types.hpp"
#include "metier/base/error.hpp"

namespace metier::virtual_edo {

/// The JSON of a text from outside; discarded (neither object nor anything else) if it is none or
/// is nested deeper than any message.
Json parseJson(std::string_view text);

/// Plain ASCII, as rosbridge sends.
std::string toText(const Json& message);

/// The id of a rosbridge request as text; empty if it has none.
std::string requestId(const Json& request);

/// Errors: invalid_argument if the field is missing or no text, in rosbridge's words.
Result<std::string> requiredText(const Json& request, const char* field);

/// Text of a field that may be missing. Errors: invalid_argument if it is no text.
Result<std::string> optionalText(const Json& request, const char* field);

/// A whole number >= 0 of a field that may be missing or null, then 0.
/// Errors: invalid_argument if it is something else.
Result<std::int64_t> optionalCount(const Json& request, const char* field);

}  // namespace metier::virtual_edo
