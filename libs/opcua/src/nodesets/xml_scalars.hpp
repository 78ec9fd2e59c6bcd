#pragma once

#include <open62541/types.h>

#include <optional>
#include <string>
#include <string_view>

namespace metier::opcua {

// Values of single elements in the XML encoding of OPC UA (OPC 10000-6, 5.3.1). Threads: any; pure.

/// "2024-05-01T00:00:00Z", with or without a fraction of a second and a zone; UTC without a zone.
std::optional<UA_DateTime> dateTimeIn(std::string_view text);
/// A number as XML spells it: with blanks around it and a leading '+', "INF", "-INF", "NaN".
std::optional<double> doubleIn(std::string_view text);
/// "true", "false", "1", "0".
std::optional<bool> booleanIn(std::string_view text);
/// The number of an enumeration: "Running_3", or "3".
std::optional<UA_Int32> enumerationIn(std::string_view text);
/// Writes a number of a built-in integer or floating-point type.
/// \return nothing, or the reason why the text is none
std::optional<std::string> readNumber(std::string_view text, const UA_DataType& type, void* target);

}  // namespace metier::opcua
