#pragma once

#include <string>
#include <string_view>

#include "metier/skill/value.hpp"

namespace metier::recording {

// Values as bytes of one process: packing one is a copy, where telling it as JSON takes a
// microsecond or more. packedJson() makes JSON of them on whichever thread has the time.

/// Replaces `packed`, whose memory is used again.
void pack(const skill::ValueMap& values, std::string& packed);
std::string packed(const skill::Value& value);
/// JSON that is to stay as it is.
std::string packedText(std::string_view json);
/// \param packed as one of the others made it
std::string packedJson(std::string_view packed);

}  // namespace metier::recording
